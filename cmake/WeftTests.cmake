# weft_tests(FOLDER [LINK lib...]): tests/FOLDER/*.cpp as one Catch2 program, each test case one CTest test.
#
# Labels: the folder's name; `slow` for the tag [slow] (left out of `./weft test`, run with --all); `heavy` for
# [heavy] (a few seconds in a release build: left out of the quick runs under a sanitizer).

function(weft_tests folder)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${folder} ${sources})
  target_include_directories(test_${folder} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(test_${folder} PRIVATE WEFT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # Test files name what they make alike (fit, run, size).
  set_target_properties(test_${folder} PROPERTIES UNITY_BUILD OFF)
  target_precompile_headers(test_${folder} PRIVATE <catch2/catch.hpp>)
  target_link_libraries(test_${folder} PRIVATE ${arg_LINK} Catch2::Catch2WithMain weft_program)

  set(list ${CMAKE_CURRENT_BINARY_DIR}/${folder}_tests.cmake)
  set(script ${PROJECT_SOURCE_DIR}/cmake/ListCatchTests.cmake)
  add_custom_command(
    OUTPUT ${list}
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:test_${folder}> -D FOLDER=${folder} -D OUTPUT=${list}
            -D "ENVIRONMENT=${WEFT_TEST_ENVIRONMENT}" -D TIMEOUT=${WEFT_TEST_TIMEOUT} -P ${script}
    DEPENDS test_${folder} ${script}
    COMMENT "Listing the tests of ${folder}/"
    VERBATIM)
  add_custom_target(list_${folder}_tests ALL DEPENDS ${list})
  # A program that is not built yet is a test that fails, not an error that hides the others.
  set(include ${CMAKE_CURRENT_BINARY_DIR}/include_${folder}_tests.cmake)
  file(WRITE ${include} "if(EXISTS \"${list}\")\n  include(\"${list}\")\nelse()\n"
                        "  add_test(\"${folder}: not built\" false)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include})
endfunction()
