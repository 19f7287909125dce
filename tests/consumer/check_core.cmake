# Included by run.cmake: kinecal::core needs Eigen alone.
set(configure_core ${CMAKE_COMMAND} -S ${WORK}/consumer/core -B ${WORK}/core ${options})

# Where something is missing, find_package says for which component, and what.
function(expect_not_found components expected)
  execute_process(COMMAND ${configure_core} "-DCOMPONENTS=${components}" RESULT_VARIABLE result
                  OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(result EQUAL 0 OR NOT output MATCHES "${expected}")
    message(FATAL_ERROR "components '${components}': not '${expected}' but ${output}")
  endif()
endfunction()
expect_not_found("" "component 'kinecal' needs what was not found: \
Ceres 2.1, urdfdom, yaml-cpp, pugixml, fmt, libyaml")
expect_not_found("core;solve" "component 'solve' needs what was not found: Ceres 2.1 ")
expect_not_found(cor "there is no component 'cor', only core, solve, io and kinecal")

execute_process(COMMAND ${configure_core} -DCOMPONENTS=core COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/core COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/core/core COMMAND_ERROR_IS_FATAL ANY)
