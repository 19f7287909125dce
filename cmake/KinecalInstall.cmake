# Installation: headers, targets and the package files that find_package(kinecal) reads.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kinecal)
install(EXPORT kinecalTargets NAMESPACE kinecal:: DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/kinecalConfig.cmake.in
  ${PROJECT_BINARY_DIR}/kinecalConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kinecalConfigVersion.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/kinecalConfig.cmake
              ${PROJECT_BINARY_DIR}/kinecalConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/KinecalAddRobot.cmake
        DESTINATION ${package_dir})
