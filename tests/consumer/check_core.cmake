# Included by run.cmake: kinecal::core needs Eigen alone, by CMake and by pkg-config.
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
Ceres 2.1, Boost 1.74, urdfdom, pugixml, fmt, ZLIB, libyaml, nlohmann_json 3.11, OpenSSL 3.0")
expect_not_found("core;solve" "component 'solve' needs what was not found: Ceres 2.1, Boost 1.74 ")
expect_not_found(cor "there is no component 'cor', only core, solve, capture, io, kinecal and headers")

execute_process(COMMAND ${configure_core} -DCOMPONENTS=core COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/core COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/core/core COMMAND_ERROR_IS_FATAL ANY)

# The installed folder may move: pkg-config finds what is beside kinecal-core.pc.
find_program(pkg_config pkg-config)
if(NOT pkg_config)
  message("without pkg-config kinecal-core.pc is not tested")
  return()
endif()
file(RENAME ${prefix} ${WORK}/moved)
set(ENV{PKG_CONFIG_PATH} ${WORK}/moved/share/pkgconfig)
function(flags_of component)
  execute_process(COMMAND ${pkg_config} --cflags --libs kinecal-${component} OUTPUT_VARIABLE flags
                  COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  set(flags ${flags} PARENT_SCOPE)
endfunction()
flags_of(core)
execute_process(COMMAND ${COMPILER} -std=c++20 ${WORK}/consumer/core/main.cpp ${flags}
                        -o ${WORK}/core/by_pkg_config COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/core/by_pkg_config COMMAND_ERROR_IS_FATAL ANY)

# A source that is compiled otherwise than the library does not link; one that stores matrices by rows
# does not compile.
function(expect_refused why expected)
  execute_process(COMMAND ${COMPILER} -std=c++20 ${ARGN} ${WORK}/consumer/core/main.cpp ${flags}
                          -o ${WORK}/core/mixed RESULT_VARIABLE result ERROR_VARIABLE output)
  if(result EQUAL 0 OR NOT output MATCHES "${expected}")
    message(FATAL_ERROR "${why}: ${output}")
  endif()
endfunction()
if(CMAKE_HOST_SYSTEM_PROCESSOR STREQUAL x86_64)
  expect_refused("another instruction set" "kinecal::x86_64_avx::kLibraryIsCompiled" -mavx)
endif()
set(aligned "kinecal::[a-z0-9_]+::EigenAlignedTo<.*>::kLibraryIsCompiled")
expect_refused("more alignment" ${aligned} -DEIGEN_MAX_ALIGN_BYTES=128)
expect_refused("no alignment" ${aligned} -DEIGEN_MAX_STATIC_ALIGN_BYTES=0)
expect_refused("no alignment at all" ${aligned} -DEIGEN_DONT_ALIGN)
expect_refused("memory that Eigen aligns" ${aligned} -DEIGEN_MALLOC_ALREADY_ALIGNED=0)
expect_refused("storage by rows" "kinecal: EIGEN_DEFAULT_TO_ROW_MAJOR is defined"
               -DEIGEN_DEFAULT_TO_ROW_MAJOR)
expect_refused("storage by rows, headers alone" "kinecal: EIGEN_DEFAULT_TO_ROW_MAJOR is defined"
               -DEIGEN_DEFAULT_TO_ROW_MAJOR -DKINECAL_HEADER_ONLY)
foreach(index IN ITEMS int "long long")
  expect_refused("${index} as index" "kinecal: EIGEN_DEFAULT_DENSE_INDEX_TYPE is not std::ptrdiff_t"
                 -DEIGEN_DEFAULT_DENSE_INDEX_TYPE=${index})
endforeach()

flags_of(io)
execute_process(COMMAND ${COMPILER} -std=c++20 ${WORK}/consumer/io.cpp ${flags}
                        -o ${WORK}/core/io COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/core/io ${WORK}/consumer/pendulum.urdf COMMAND_ERROR_IS_FATAL ANY)
flags_of(capture)
execute_process(COMMAND ${COMPILER} -std=c++20 ${WORK}/consumer/finders.cpp ${flags}
                        -o ${WORK}/core/finders COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/core/finders COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${WORK}/moved ${prefix})
