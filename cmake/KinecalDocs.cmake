# `cmake --build <build> --target docs` writes the API reference to <build>/docs/html/index.html.
# A public type or function without a docstring is an error, and a link that leads nowhere; a member whose
# name and type say all needs none.  The target exists only if Doxygen is installed.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  message(STATUS "kinecal: doxygen was not found; the target docs is not available")
  return()
endif()

set(KINECAL_DOCS_DIR ${PROJECT_BINARY_DIR}/docs)
configure_file(${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
add_custom_target(docs
  COMMAND ${PROJECT_SOURCE_DIR}/cmake/docs.sh ${DOXYGEN_EXECUTABLE} ${PROJECT_BINARY_DIR}/Doxyfile
          ${KINECAL_DOCS_DIR}
  COMMENT "API reference: ${KINECAL_DOCS_DIR}/html/index.html"
  VERBATIM)
