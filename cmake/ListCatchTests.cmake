# Writes a CTest file with every test case of a Catch2 program, its tags [slow] and [heavy] as labels.
#
# Catch2 2.13's own catch_discover_tests knows no labels, and warns where a tag selects nothing.
# Input: PROGRAM, FOLDER, OUTPUT, ENVIRONMENT, TIMEOUT (seconds; slow tests get 12 times as long).

cmake_minimum_required(VERSION 3.25)

function(names_of spec variable)
  execute_process(COMMAND ${PROGRAM} "${spec}" --list-test-names-only OUTPUT_VARIABLE output ERROR_VARIABLE error)
  # The exit code is the number of tests, so failure shows on stderr only.
  if(error)
    message(FATAL_ERROR "${PROGRAM} cannot list its tests:\n${error}")
  endif()
  if(output MATCHES "[][;]")
    message(FATAL_ERROR "${PROGRAM}: the name of a test may not hold [, ] or ;")
  endif()
  string(REGEX MATCHALL "[^\n]+" names "${output}")
  set(${variable} "${names}" PARENT_SCOPE)
endfunction()

names_of("*" all)
names_of("[slow]" slow)
names_of("[heavy]" heavy)

set(text "")
foreach(name IN LISTS all)
  set(labels ${FOLDER})
  set(timeout ${TIMEOUT})
  if(name IN_LIST slow)
    list(APPEND labels slow)
    math(EXPR timeout "12 * ${TIMEOUT}")
  endif()
  if(name IN_LIST heavy)
    list(APPEND labels heavy)
  endif()
  string(REPLACE "," "\\," spec "${name}")  # a comma would end the name
  string(APPEND text
    "add_test([==[${FOLDER}: ${name}]==] [==[${PROGRAM}]==] [==[${spec}]==])\n"
    "set_tests_properties([==[${FOLDER}: ${name}]==] PROPERTIES TIMEOUT ${timeout} LABELS \"${labels}\""
    " SKIP_REGULAR_EXPRESSION skipped:"
    " ENVIRONMENT [==[${ENVIRONMENT}]==])\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
