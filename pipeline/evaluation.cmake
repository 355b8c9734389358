# The commands rank and reproduce. The papers' figures and the experiments are built in; eval/ is their one source.
set(VOROFORM_EMBEDDED_FILES "")
foreach(file IN ITEMS published/table-3.1.csv published/table-3.2.csv
    published/table-4.1.csv published/table-4.2.csv published/table-4.3.csv published/table-4.4.csv published/table-4.5.csv
    published/table-4.6.csv published/table-4.7.csv published/figure-3.8.csv published/figure-3.9.csv
    published/figure-4.10.csv published/table-5.1.csv published/table-5.2.csv published/table-5.3.csv
    published/table-5.4.csv published/figure-5.7.csv experiments/meshes.toml)
  set(path ${PROJECT_SOURCE_DIR}/eval/${file})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
  file(READ ${path} content)
  string(APPEND VOROFORM_EMBEDDED_FILES "    {\"${file}\", R\"~(${content})~\"},\n")
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/src/embedded_files.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/embedded_files.cpp @ONLY)
target_sources(voroform_pipeline PRIVATE
  ${CMAKE_CURRENT_BINARY_DIR}/embedded_files.cpp
  src/experiment.cpp
  src/published_figures.cpp
  src/rank.cpp
  src/rank_markdown.cpp
  src/rank_records.cpp
  src/rank_statistics.cpp
  src/rank_tables.cpp
  src/reproduce.cpp
  src/reproduce_bodies.cpp
  src/reproduce_curves.cpp
  src/reproduce_cvt.cpp
  src/reproduce_records.cpp
  src/svg_drawing.cpp
  src/svg_rankings.cpp)
# Header-only, so that programs that link the library need not link toml++ as well.
set_source_files_properties(src/experiment.cpp PROPERTIES COMPILE_DEFINITIONS TOML_HEADER_ONLY=1)
