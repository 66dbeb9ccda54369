# How this project declares libraries, tools and tests. Warnings are on for our code; generated code sits in a library of its own
# and does not use these functions.

set(PMAC_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual)
option(PMAC_WERROR "Treat warnings as errors" OFF)
if(PMAC_WERROR)
  list(APPEND PMAC_WARNINGS -Werror)
endif()

# pmac_library(name SOURCES a.cpp ... USES other_library ...)
function(pmac_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_compile_options(${name} PRIVATE ${PMAC_WARNINGS})
  target_link_libraries(${name} PUBLIC ${ARG_USES})
endfunction()

# pmac_tool(name SOURCES a.cpp ... USES library ...)
function(pmac_tool name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_compile_options(${name} PRIVATE ${PMAC_WARNINGS})
  target_link_libraries(${name} PRIVATE ${ARG_USES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()

# Seconds that a test may take at the most: sanitizers are slow.
set(PMAC_TEST_TIMEOUT 120)
if(PMAC_SANITIZE)
  set(PMAC_TEST_TIMEOUT 1200)
endif()

# pmac_test(name SOURCES a_test.cpp ... USES library ...): one executable, one CTest case for each TEST_CASE
function(pmac_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_compile_options(${name} PRIVATE ${PMAC_WARNINGS} -O1)  # the test header is large, the tests' own code is not
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE pmac_test_main ${ARG_USES})
  target_compile_definitions(${name} PRIVATE PMAC_SOURCE_DIR="${CMAKE_SOURCE_DIR}" PMAC_BINARY_DIR="${CMAKE_BINARY_DIR}")
  catch_discover_tests(${name} TEST_PREFIX "${name}: " PROPERTIES TIMEOUT ${PMAC_TEST_TIMEOUT})
endfunction()
