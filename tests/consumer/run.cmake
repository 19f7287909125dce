# Builds and runs the consumer against kinecal as its users have it:
#   cmake -DMODE=install|source|headers -DSOURCE=... -DBUILD=... -DWORK=... -DCOMPILER=... -P run.cmake
# install  what `cmake --install` installs
# source   what FetchContent fetches
# headers  the headers alone, of a source that was configured and not built
file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)
set(options -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER=${COMPILER} -G Ninja)

if(MODE STREQUAL headers)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/bare ${options}
                          -DKINECAL_BUILD_TESTS=OFF -DKINECAL_BUILD_BENCHMARKS=OFF
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${WORK}/bare --component headers
                          --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  foreach(file README.md MANUAL.md CONCEPTS.md ARCHITECTURE.md copyright examples/02_calibrate.cpp)
    if(NOT EXISTS ${prefix}/share/doc/libkinecal-dev/${file})
      message(FATAL_ERROR "${file} is not installed")
    endif()
  endforeach()
  file(COPY ${SOURCE}/tests/consumer/ DESTINATION ${WORK}/consumer)
  set(configure ${CMAKE_COMMAND} -S ${WORK}/consumer/core -B ${WORK}/core ${options}
                -DCMAKE_PREFIX_PATH=${prefix})
  execute_process(COMMAND ${configure} -DCOMPONENTS=core RESULT_VARIABLE result
                  OUTPUT_QUIET ERROR_VARIABLE output)
  if(result EQUAL 0 OR NOT output MATCHES "headers alone are")
    message(FATAL_ERROR "component 'core' without its library: ${output}")
  endif()
  execute_process(COMMAND ${configure} -DCOMPONENTS=headers COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/core COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${WORK}/core/core COMMAND_ERROR_IS_FATAL ANY)

  # Solving needs Ceres, and no library of kinecal.
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK}/consumer/headers -B ${WORK}/headers ${options}
                          -DCMAKE_PREFIX_PATH=${prefix} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/headers COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${WORK}/headers/headers COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE installed ${prefix}/*.cpp ${prefix}/include/kinecal/trust/*.ipp)
  list(FILTER installed INCLUDE REGEX "/include/")
  if(installed)
    message(FATAL_ERROR "only the libraries are compiled of these, but they are installed: ${installed}")
  endif()
  return()
endif()

if(MODE STREQUAL install)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endif()

if(PROGRAM AND NOT MODE STREQUAL source)
  # Installed, it is what it is in the build tree, chosen instruction set included.
  execute_process(COMMAND ${PROGRAM} --version OUTPUT_VARIABLE built COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${prefix}/bin/kinecal --version OUTPUT_VARIABLE installed
                  COMMAND_ERROR_IS_FATAL ANY)
  if(NOT installed STREQUAL built)
    message(FATAL_ERROR "installed: ${installed}built: ${built}")
  endif()
  foreach(file doc/kinecal/README.md doc/kinecal/CONTRIBUTING.md doc/kinecal/examples/pipe_robot/README.md man/man1/kinecal.1 bash-completion/completions/kinecal
               zsh/vendor-completions/_kinecal)
    file(GLOB installed ${prefix}/share/${file} ${prefix}/share/${file}.gz)
    if(NOT installed)
      message(FATAL_ERROR "${file} is not installed")
    endif()
  endforeach()
endif()

file(COPY ${SOURCE}/tests/consumer/ DESTINATION ${WORK}/consumer)
if(MODE STREQUAL source)
  set(consumer_options -DKINECAL_FROM_SOURCE=${SOURCE})
else()
  list(APPEND options -DCMAKE_PREFIX_PATH=${prefix})
endif()
if(MODE STREQUAL install)
  set(consumer_options -DKINECAL_EXAMPLES=${prefix}/share/doc/libkinecal-dev/examples)
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK}/consumer -B ${WORK}/build ${options}
                        ${consumer_options} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/build/consumer COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/build/finders COMMAND_ERROR_IS_FATAL ANY)

# The program with a sensor and an error block of a user's own, and the configuration beside it.
if(MODE STREQUAL install AND PROGRAM)
  set(examples ${prefix}/share/doc/libkinecal-dev/examples)
  execute_process(COMMAND ${WORK}/build/own_program check --config ${examples}/own_program/calibrate.yaml
                          --urdf ${examples}/mobile_manipulator/mobile_manipulator.urdf
                  COMMAND_ERROR_IS_FATAL ANY)
endif()

# A calibrator of a user's own: six lines of CMake, forty of C++ and a URDF.
if(MODE STREQUAL install)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK}/consumer/calibrator -B ${WORK}/calibrator
                          ${options} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/calibrator COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${WORK}/calibrator/calibrator COMMAND_ERROR_IS_FATAL ANY)
endif()

set(HERE ${CMAKE_CURRENT_LIST_DIR})
if(MODE STREQUAL install)
  include(${HERE}/check_core.cmake)
endif()
include(${HERE}/check_robot_header.cmake)
