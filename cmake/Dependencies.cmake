# Third-party libraries, all from Debian 12 packages. The reason for each stands in docs/dependencies.md.
find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(Ceres REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

# CGAL's own configuration prints notes on build types and adds flags we do not want.
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
set(CGAL_DISABLE_GMP FALSE)
find_package(CGAL 5.5 QUIET REQUIRED)

find_package(nlohmann_json REQUIRED)
