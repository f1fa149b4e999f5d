# cmake --install: bin/weft, the headers, share/weft/scenes, share/weft/slurm, and a package for find_package(weft).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(libraries btf settings images tracer codecs acquisition gl_preview study)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/weft)

install(TARGETS weft RUNTIME)
foreach(library IN LISTS libraries)
  install(TARGETS weft_${library} EXPORT weftTargets ARCHIVE)
  install(DIRECTORY ${library}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/weft/${library} FILES_MATCHING PATTERN "*.h")
endforeach()
if(EXISTS ${PROJECT_SOURCE_DIR}/scenes)
  install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/weft)
endif()
install(PROGRAMS acquisition/slurm/acquire.sbatch DESTINATION ${CMAKE_INSTALL_DATADIR}/weft/slurm)

install(EXPORT weftTargets NAMESPACE weft:: DESTINATION ${package_folder})
configure_package_config_file(cmake/weftConfig.cmake.in ${PROJECT_BINARY_DIR}/weftConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/weftConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/weftConfig.cmake ${PROJECT_BINARY_DIR}/weftConfigVersion.cmake
              cmake/WeftPackages.cmake cmake/FindOpenSubdiv.cmake
        DESTINATION ${package_folder})
