# The Python package `kinecal`: the module _kinecal and the sources beside it, as users import them.
#   build/<preset>/python/kinecal     for tests: PYTHONPATH=build/test/python
#   KINECAL_PYTHON_FOLDER             where it is installed: that of Debian's packages, or of a wheel (cmake/wheel.py)
#
# Not with sanitizers, whose library must be loaded before Python's program.
if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)  # Debian's, whose package this is, even if another one is on the PATH
endif()
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 QUIET)
if(NOT pybind11_FOUND OR NOT Python_Development.Module_FOUND OR KINECAL_SANITIZE OR BUILD_SHARED_LIBS
   OR KINECAL_HEADER_ONLY)
  message(STATUS "kinecal: without pybind11-dev and python3-dev, with sanitizers or shared libraries, no Python package")
  return()
endif()

set(KINECAL_PYTHON_FOLDER lib/python3/dist-packages CACHE STRING "Where the Python package is installed")
set(folder ${PROJECT_SOURCE_DIR}/include/kinecal/python)
file(GLOB modules CONFIGURE_DEPENDS ${folder}/*.cpp)
file(GLOB sources CONFIGURE_DEPENDS ${folder}/kinecal/*.py ${folder}/kinecal/*.pyi ${folder}/kinecal/py.typed)
kinecal_group_sources(units python 2 ${PROJECT_SOURCE_DIR}/include ${modules})
pybind11_add_module(kinecal_python MODULE NO_EXTRAS ${units})
kinecal_link_levels(kinecal_python)
target_link_libraries(kinecal_python PRIVATE kinecal::io fmt::fmt kinecal_build_options)
target_compile_features(kinecal_python PRIVATE cxx_std_20)
target_compile_options(kinecal_python PRIVATE $<$<CONFIG:Release>:-O1>)
target_compile_definitions(kinecal_python PRIVATE KINECAL_VERSION="${PROJECT_VERSION}")
file(RELATIVE_PATH libraries /${KINECAL_PYTHON_FOLDER}/kinecal /${CMAKE_INSTALL_LIBDIR}/kinecal)
set(built ${PROJECT_BINARY_DIR}/python/kinecal)
set_target_properties(kinecal_python PROPERTIES
  OUTPUT_NAME _kinecal LIBRARY_OUTPUT_DIRECTORY ${built} INSTALL_RPATH "$ORIGIN/${libraries}")

set(copies "")
foreach(source IN LISTS sources)
  cmake_path(GET source FILENAME name)
  add_custom_command(OUTPUT ${built}/${name} DEPENDS ${source} VERBATIM
                     COMMAND ${CMAKE_COMMAND} -E copy ${source} ${built}/${name})
  list(APPEND copies ${built}/${name})
endforeach()
add_custom_target(kinecal_python_sources ALL DEPENDS ${copies})
add_dependencies(kinecal_python kinecal_python_sources)

if(KINECAL_INSTALL)
  install(TARGETS kinecal_python LIBRARY DESTINATION ${KINECAL_PYTHON_FOLDER}/kinecal COMPONENT python)
  install(FILES ${sources} DESTINATION ${KINECAL_PYTHON_FOLDER}/kinecal COMPONENT python)
endif()

if(KINECAL_BUILD_TESTS)
  set(environment PYTHONPATH=${PROJECT_BINARY_DIR}/python KINECAL=$<TARGET_FILE:kinecal_program> PYTHONDONTWRITEBYTECODE=1)
  add_test(NAME python COMMAND ${Python_EXECUTABLE} -m unittest discover --start-directory ${PROJECT_SOURCE_DIR}/tests/python)
  set_tests_properties(python PROPERTIES ENVIRONMENT "${environment}" TIMEOUT 300 COST 300)
  find_program(KINECAL_MYPY mypy)
  if(KINECAL_MYPY)
    add_test(NAME python_types COMMAND ${KINECAL_MYPY} --strict --cache-dir ${PROJECT_BINARY_DIR}/mypy
             ${folder}/kinecal ${PROJECT_SOURCE_DIR}/examples/python)
  endif()
endif()
