# weft_library(FOLDER [PUBLIC lib...] [PRIVATE lib...]): the one library of a folder, from all its sources.

function(weft_library folder)
  cmake_parse_arguments(arg "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(weft_${folder} STATIC ${sources})
  add_library(weft::${folder} ALIAS weft_${folder})
  set_target_properties(weft_${folder} PROPERTIES EXPORT_NAME ${folder} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(weft_${folder} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/weft>)
  target_link_libraries(weft_${folder} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:weft_compiler>)
  # Headers pass vectors of sixteen floats through inline functions: how depends on the CPU, so that a program that
  # uses an installed library is compiled for the CPU that the library was.
  target_compile_options(weft_${folder} INTERFACE $<INSTALL_INTERFACE:-march=${WEFT_ARCH}>
                                                  $<INSTALL_INTERFACE:-Wno-psabi>)
endfunction()
