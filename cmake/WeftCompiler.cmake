# Warnings, architecture, sanitizers and the fast linker, for every target of ours.

add_library(weft_compiler INTERFACE)
target_compile_options(weft_compiler INTERFACE -Wall -Wextra -Werror)
# GCC 12 sees an overlap in "literal" + std::string that cannot be (its bug 105651).
target_compile_options(weft_compiler INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# Contraction into fused multiply-adds is left on: results are the same for one build on one kind of CPU.
target_compile_options(weft_compiler INTERFACE -march=${WEFT_ARCH})
# Nothing reads errno after a square root, or traps on a NaN; both would keep loops from being vectorised.
target_compile_options(weft_compiler INTERFACE -fno-math-errno -fno-trapping-math)
# Vectors of sixteen floats stay within a program that is built in one go.
target_compile_options(weft_compiler INTERFACE -Wno-psabi)
if(WEFT_SANITIZE)
  # g++ 12 takes the undefined vectors of its own intrinsics for mistakes where checks are woven in.
  target_compile_options(weft_compiler INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized)
  # The first mistake ends a program: code that could go on after one takes a third more time to compile.
  target_compile_options(weft_compiler INTERFACE -fsanitize=${WEFT_SANITIZE} -fno-sanitize-recover=all
                                                 -fno-omit-frame-pointer -g1)
  target_link_options(weft_compiler INTERFACE -fsanitize=${WEFT_SANITIZE})
endif()
# OpenGL without X headers; Eigen's own threads off (TBB runs the outer loops).
target_compile_definitions(weft_compiler INTERFACE EIGEN_DONT_PARALLELIZE)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Precompiled headers are cached only where ccache may ignore their times.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM)
  add_link_options(-fuse-ld=mold)
endif()
