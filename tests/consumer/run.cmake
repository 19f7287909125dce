# Builds and runs the consumer: cmake -DMODE=install|source -DSOURCE=... -DBUILD=... -DWORK=... -P
file(REMOVE_RECURSE ${WORK})
set(options -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${COMPILER} -G Ninja)
if(MODE STREQUAL install)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  if(PROGRAM)  # installed, it is what it is in the build tree, chosen instruction set included
    execute_process(COMMAND ${PROGRAM} --version OUTPUT_VARIABLE built COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${WORK}/prefix/bin/kinecal --version OUTPUT_VARIABLE installed
                    COMMAND_ERROR_IS_FATAL ANY)
    if(NOT installed STREQUAL built)
      message(FATAL_ERROR "installed: ${installed}built: ${built}")
    endif()
  endif()
  list(APPEND options -DCMAKE_PREFIX_PATH=${WORK}/prefix -DKINECAL_EXAMPLES=${SOURCE}/examples)
else()
  list(APPEND options -DKINECAL_FROM_SOURCE=${SOURCE})
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/consumer -B ${WORK}/build ${options}
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/build/consumer COMMAND_ERROR_IS_FATAL ANY)
