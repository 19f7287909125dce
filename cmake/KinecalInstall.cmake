# Installation: headers, targets and the package files that find_package(kinecal) reads.
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
