# `cmake --build <build> --target docs` writes the API reference to <build>/docs/html/index.html.
# A public name without a docstring is an error.  The target exists only if Doxygen is installed.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  message(STATUS "kinecal: doxygen was not found; the target docs is not available")
  return()
endif()

set(KINECAL_DOCS_DIR ${PROJECT_BINARY_DIR}/docs)
configure_file(${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
add_custom_target(docs
  COMMAND ${CMAKE_COMMAND} -E make_directory ${KINECAL_DOCS_DIR}
  COMMAND ${DOXYGEN_EXECUTABLE} ${PROJECT_BINARY_DIR}/Doxyfile
  COMMENT "API reference: ${KINECAL_DOCS_DIR}/html/index.html"
  VERBATIM)
