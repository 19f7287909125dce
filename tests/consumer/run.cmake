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
file(COPY ${SOURCE}/tests/consumer/ DESTINATION ${WORK}/consumer)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK}/consumer -B ${WORK}/build ${options}
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/build/consumer COMMAND_ERROR_IS_FATAL ANY)

# The robot's header follows its URDF; a mistake there is told with its line, and the header stays.
set(urdf ${WORK}/consumer/pendulum.urdf)
set(header ${WORK}/build/pendulum_include/robots/pendulum.hpp)
set(build_robot ${CMAKE_COMMAND} --build ${WORK}/build --target pendulum)

function(replace_in_urdf before after)
  file(READ ${urdf} text)
  string(REPLACE "${before}" "${after}" text "${text}")
  file(WRITE ${urdf} "${text}")
endfunction()

function(check_header expected)
  file(READ ${header} text)
  if(NOT text MATCHES "translation = {0.0, 0.0, ${expected}}")
    message(FATAL_ERROR "${header}: is not at ${expected}:\n${text}")
  endif()
endfunction()

check_header(0.75)
replace_in_urdf("0 0 0.75" "0 0 0.5")
execute_process(COMMAND ${build_robot} COMMAND_ERROR_IS_FATAL ANY)
check_header(0.5)
replace_in_urdf("0 0 0.5" "0 0 half")
execute_process(COMMAND ${build_robot} RESULT_VARIABLE result OUTPUT_VARIABLE output
                ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "consumer/pendulum.urdf:6: joint 'pivot': .*not 3 numbers")
  message(FATAL_ERROR "a mistake in the URDF is not told: ${output}")
endif()
check_header(0.5)
