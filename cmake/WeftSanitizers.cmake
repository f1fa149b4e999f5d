# weft_program: what every executable of ours links; under thread sanitizer also what shows it TBB's and Embree's order.
# WEFT_TEST_ENVIRONMENT, WEFT_TEST_TIMEOUT: what tests run with, and how long one may take, under a sanitizer.

add_library(weft_program INTERFACE)
target_link_libraries(weft_program INTERFACE weft_compiler)
if(WEFT_SANITIZE MATCHES "thread")
  add_library(weft_thread_order OBJECT ${PROJECT_SOURCE_DIR}/tests/sanitizers/tbb_order.cpp
    ${PROJECT_SOURCE_DIR}/tests/sanitizers/embree_commit.cpp)
  target_link_libraries(weft_thread_order PRIVATE weft_compiler TBB::tbb)
  target_sources(weft_program INTERFACE $<TARGET_OBJECTS:weft_thread_order>)
  target_link_libraries(weft_program INTERFACE TBB::tbb)
endif()

set(WEFT_TEST_ENVIRONMENT "")
set(WEFT_TEST_TIMEOUT 300)  # seconds
if(WEFT_SANITIZE)
  set(WEFT_TEST_TIMEOUT 1200)
  set(suppressions ${PROJECT_SOURCE_DIR}/tests/sanitizers)
  set(WEFT_TEST_ENVIRONMENT
    "ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1"
    "LSAN_OPTIONS=suppressions=${suppressions}/lsan.supp:print_suppressions=0"
    "UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1"
    "TSAN_OPTIONS=suppressions=${suppressions}/tsan.supp:halt_on_error=1")
endif()
