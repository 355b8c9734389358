# One helper adds a module, one adds a test. The layers of docs/architecture.md are enforced here: a module that names a
# dependency outside its row of the table fails to configure, and since every module has an include folder of its own,
# an include across the layers fails to compile.
set(VOROFORM_MAY_USE_core "")
set(VOROFORM_MAY_USE_mesh core)
set(VOROFORM_MAY_USE_points core mesh)
set(VOROFORM_MAY_USE_implicit core mesh points)
set(VOROFORM_MAY_USE_voronoi core mesh implicit)
set(VOROFORM_MAY_USE_cvt core mesh implicit voronoi)
set(VOROFORM_MAY_USE_baselines core mesh implicit)
set(VOROFORM_MAY_USE_metrics core mesh implicit voronoi cvt)

add_library(voroform_flags INTERFACE)
target_compile_options(voroform_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # g++ 12 warns falsely about std::string's own operator+ (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${VOROFORM_WERROR}>:-Werror>)
if(VOROFORM_SANITIZE)
  target_compile_options(voroform_flags INTERFACE
    -fsanitize=${VOROFORM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(voroform_flags INTERFACE -fsanitize=${VOROFORM_SANITIZE})
endif()

# voroform_add_module(NAME SOURCES a.cpp … [DEPENDS module …] [PRIVATE third-party target …])
function(voroform_add_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE" ${ARGN})
  foreach(dependency IN LISTS ARG_DEPENDS)
    if(NOT dependency IN_LIST VOROFORM_MAY_USE_${name})
      message(FATAL_ERROR "module ${name} may not use ${dependency}: it may use [${VOROFORM_MAY_USE_${name}}]")
    endif()
  endforeach()
  set(target voroform_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(voroform::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC Eigen3::Eigen)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC voroform::${dependency})
  endforeach()
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:voroform_flags>)
  foreach(library IN LISTS ARG_PRIVATE)
    target_link_libraries(${target} PRIVATE ${library})
    if(TARGET ${library}) # third-party headers are no business of our warnings
      get_target_property(folders ${library} INTERFACE_INCLUDE_DIRECTORIES)
      if(folders)
        target_include_directories(${target} SYSTEM PRIVATE ${folders})
      endif()
    endif()
  endforeach()
  install(TARGETS ${target} EXPORT voroformTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# voroform_add_test(NAME FILE [LABEL unit|property|cli|slow] [LINKS target …] [TIMEOUT seconds])
# Builds one GoogleTest program; its cases are discovered and carry the label.
function(voroform_add_test name file)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "LINKS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${file})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gmock_main GTest::gmock $<BUILD_INTERFACE:voroform_flags>)
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
