# Included by run.cmake: a robot's header follows its URDF.  An error in the URDF is reported with its
# line, and the header stays.
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
  message(FATAL_ERROR "the error in the URDF is not reported: ${output}")
endif()
check_header(0.5)
