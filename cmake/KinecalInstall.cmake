# Installation: libraries, headers, and the package files for find_package(kinecal) and pkg-config.
#
#   cmake --install <build> --component headers     the headers alone, without building anything
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kinecal)
install(TARGETS kinecal_headers EXPORT kinecal-headers COMPONENT headers)
install(EXPORT kinecal-headers NAMESPACE kinecal:: DESTINATION ${package_dir} COMPONENT headers)
foreach(component core capture solve io kinecal)
  install(EXPORT kinecal-${component} NAMESPACE kinecal:: DESTINATION ${package_dir})
endforeach()
foreach(folder IN LISTS KINECAL_CORE_FOLDERS ITEMS solve)  # what KINECAL_HEADER_ONLY includes
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/kinecal/${folder}
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kinecal COMPONENT headers
          FILES_MATCHING PATTERN "*.ipp")
endforeach()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/kinecalConfig.cmake.in
  ${PROJECT_BINARY_DIR}/kinecalConfig.cmake INSTALL_DESTINATION ${package_dir})
# Not ARCH_INDEPENDENT: the headers are, but the libraries and programs are of one architecture.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kinecalConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kinecalConfig.cmake
              ${PROJECT_BINARY_DIR}/kinecalConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/KinecalAddRobot.cmake
        DESTINATION ${package_dir} COMPONENT headers)

# For builds without CMake.  Paths are relative to the file, so you can move the folder.
set(pkgconfig_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)
file(RELATIVE_PATH prefix_from_pc /${pkgconfig_dir} /)
set(sanitizers "")
if(KINECAL_SANITIZE)
  set(sanitizers " -fsanitize=address,undefined")
endif()
set(native "")
if(KINECAL_NATIVE)
  set(native " -march=native")
endif()
foreach(component core capture solve io)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/package/kinecal-${component}.pc.in
    ${PROJECT_BINARY_DIR}/kinecal-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/kinecal-${component}.pc DESTINATION ${pkgconfig_dir})
endforeach()

find_program(KINECAL_GZIP gzip)
# Each package has all texts and what they link to: the headers may be installed without the program.
set(library_doc ${CMAKE_INSTALL_DATADIR}/doc/libkinecal-dev)
set(texts README.md MANUAL.md BACKGROUND.md CONCEPTS.md ARCHITECTURE.md CONTRIBUTING.md LICENSE cmake/package/copyright)
list(TRANSFORM texts PREPEND ${PROJECT_SOURCE_DIR}/)
foreach(pair ${CMAKE_INSTALL_DOCDIR}=program ${library_doc}=headers)
  string(REPLACE "=" ";" pair ${pair})
  list(GET pair 0 folder)
  list(GET pair 1 component)
  install(FILES ${texts} DESTINATION ${folder} COMPONENT ${component})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${folder} COMPONENT ${component}
          PATTERN "demo.sh" EXCLUDE)
endforeach()
if(KINECAL_GZIP)  # as Debian wants it
  set(changelog ${PROJECT_BINARY_DIR}/package/changelog)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/package/changelog.in ${changelog} @ONLY)
  execute_process(COMMAND ${KINECAL_GZIP} -9nkf ${changelog} COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${changelog}.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  install(FILES ${changelog}.gz DESTINATION ${library_doc} COMPONENT headers)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/cmake/package/lintian-overrides RENAME kinecal
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT program)
file(GLOB schemas ${PROJECT_SOURCE_DIR}/include/kinecal/*/schema/*.json)
install(FILES ${schemas} DESTINATION ${CMAKE_INSTALL_DATADIR}/kinecal/schema COMPONENT program)
