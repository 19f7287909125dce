# Installation: headers, targets and the package files that find_package(kinecal) and pkg-config read.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kinecal)
foreach(component core solve io kinecal)
  install(EXPORT kinecal-${component} NAMESPACE kinecal:: DESTINATION ${package_dir})
endforeach()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/kinecalConfig.cmake.in
  ${PROJECT_BINARY_DIR}/kinecalConfig.cmake INSTALL_DESTINATION ${package_dir})
# Not ARCH_INDEPENDENT: the headers are, but the programs beside them are of one architecture.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kinecalConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kinecalConfig.cmake
              ${PROJECT_BINARY_DIR}/kinecalConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/KinecalAddRobot.cmake
        DESTINATION ${package_dir})

# For those who build without CMake.  Its paths are relative to itself, so that the folder may move.
set(pkgconfig_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)
file(RELATIVE_PATH prefix_from_pc /${pkgconfig_dir} /)
configure_file(${PROJECT_SOURCE_DIR}/cmake/package/kinecal-core.pc.in
  ${PROJECT_BINARY_DIR}/kinecal-core.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/kinecal-core.pc DESTINATION ${pkgconfig_dir})

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/cmake/package/copyright
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/package.xml  # by which ROS knows what is installed
        DESTINATION ${CMAKE_INSTALL_DATADIR}/kinecal)
