# Every package that Weft builds on, each found once. All come from Debian (see packages.txt).

find_package(Threads REQUIRED)
find_package(TBB REQUIRED)  # before Embree, whose own config looks for it
find_package(Eigen3 3.4 REQUIRED)
find_package(Imath CONFIG REQUIRED)
find_package(OpenEXR CONFIG REQUIRED)
find_package(embree 3.13 CONFIG REQUIRED)
if(NOT embree_VERSION VERSION_LESS 4)
  message(FATAL_ERROR "Weft uses Embree's v3 interface; found ${embree_VERSION}")
endif()
find_package(OpenSubdiv REQUIRED)
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(tinyobjloader REQUIRED)
find_package(assimp REQUIRED)
find_package(glfw3 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(lbfgs REQUIRED IMPORTED_TARGET liblbfgs)
pkg_check_modules(epoxy REQUIRED IMPORTED_TARGET epoxy)
pkg_check_modules(egl REQUIRED IMPORTED_TARGET egl)
pkg_check_modules(imgui REQUIRED IMPORTED_TARGET imgui)

# Debian's OpenImageIO config names an include folder that does not exist (opencv4); say the right one.
find_package(OpenImageIO 2.4 CONFIG REQUIRED)
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR}")
