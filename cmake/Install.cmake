# Installs the library's targets and a package, so that other projects can say find_package(voroform) and link
# voroform::pipeline or single modules. tests/consumer does just that.
include(CMakePackageConfigHelpers)

set(VOROFORM_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/voroform)
install(EXPORT voroformTargets NAMESPACE voroform:: DESTINATION ${VOROFORM_PACKAGE_FOLDER})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/voroformConfig.cmake.in
  ${PROJECT_BINARY_DIR}/voroformConfig.cmake INSTALL_DESTINATION ${VOROFORM_PACKAGE_FOLDER})
# Before 1.0 each minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/voroformConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/voroformConfig.cmake ${PROJECT_BINARY_DIR}/voroformConfigVersion.cmake
  DESTINATION ${VOROFORM_PACKAGE_FOLDER})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
