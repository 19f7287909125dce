# One program for every x86-64 processor, each at its best.
#
# The evaluation holds as many samples at once as the instruction set it is compiled for has lanes.
# So what evaluates and solves (kinecal::core and kinecal::solve, not the files of kinecal::io) is
# compiled once for each level, into shared libraries of one name:
#   lib/kinecal/libkinecal_evaluation.so                            any x86-64
#   lib/kinecal/glibc-hwcaps/x86-64-v3/libkinecal_evaluation.so     AVX2
#   lib/kinecal/glibc-hwcaps/x86-64-v4/libkinecal_evaluation.so     AVX-512
# and the dynamic loader takes the best that the processor has (glibc 2.33; older ones the first).
# Objects for different levels must not meet in one file: their inline functions have the same names,
# and the linker would take one of them for all.  The same holds for a static Ceres, which is compiled
# for the baseline: its shared library is taken instead.  What crosses the border between program and
# library is virtual functions and plain data; Eigen's matrices of variable size do not, as their
# alignment differs.
# Source: ld.so(8), glibc-hwcaps; x86-64 psABI, micro-architecture levels.

# The shared library of Ceres, or empty.  Debian's package has both libraries, but names the static
# one.
function(kinecal_shared_ceres result)
  get_target_property(ceres Ceres::ceres LOCATION)
  string(REGEX REPLACE "\\.a$" ".so" ceres "${ceres}")
  if(NOT EXISTS "${ceres}")
    set(ceres "")
  endif()
  set(${result} "${ceres}" PARENT_SCOPE)
endfunction()

set(KINECAL_LEVELS "")
if(KINECAL_X86_64_LEVELS)
  kinecal_shared_ceres(KINECAL_CERES)
  set(why_not "")
  if(KINECAL_NATIVE OR KINECAL_SANITIZE)
    set(why_not "with KINECAL_NATIVE or KINECAL_SANITIZE")
  elseif(NOT "${CMAKE_SYSTEM_NAME} ${CMAKE_SYSTEM_PROCESSOR}" MATCHES "^Linux (x86_64|AMD64)$")
    set(why_not "on ${CMAKE_SYSTEM_NAME}, ${CMAKE_SYSTEM_PROCESSOR}")
  elseif(NOT KINECAL_CERES)
    set(why_not "without a shared library of Ceres")
  else()
    set(KINECAL_LEVELS x86-64 x86-64-v3 x86-64-v4)
  endif()
  if(why_not)
    message(STATUS "KINECAL_X86_64_LEVELS has no effect ${why_not}")
  endif()
endif()

# Links a program with the evaluation at each level, or with kinecal::solve.
function(kinecal_link_levels program)
  if(NOT KINECAL_LEVELS)
    target_link_libraries(${program} PRIVATE kinecal::solve)
    return()
  endif()
  foreach(level IN LISTS KINECAL_LEVELS)
    add_dependencies(${program} kinecal_evaluation_${level})
  endforeach()
  # Before kinecal::io, whose references the static kinecal::solve would resolve otherwise.
  target_link_libraries(${program} PRIVATE kinecal_evaluation_x86-64)
  file(RELATIVE_PATH from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/kinecal)
  set_target_properties(${program} PROPERTIES
    BUILD_RPATH_USE_ORIGIN ON
    INSTALL_RPATH "$ORIGIN/${from_bin}")
endfunction()

function(kinecal_add_level level)
  set(folder ${CMAKE_INSTALL_LIBDIR}/kinecal)
  if(NOT level STREQUAL x86-64)
    string(APPEND folder /glibc-hwcaps/${level})
  endif()
  set(target kinecal_evaluation_${level})
  if(level STREQUAL x86-64)
    add_library(${target} SHARED $<TARGET_OBJECTS:kinecal_core> $<TARGET_OBJECTS:kinecal_solve>)
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)
  else()
    add_library(${target} SHARED ${KINECAL_UNITS_core} ${KINECAL_UNITS_solve}
                                 ${KINECAL_PACKET_INSTANCES})
    # The program is compiled for the baseline and refers to the baseline's check: see linkage.hpp.
    set(check ${CMAKE_CURRENT_BINARY_DIR}/kinecal_level_check.cpp)
    file(CONFIGURE OUTPUT ${check} CONTENT
      "namespace kinecal { namespace x86_64 { extern const bool kLibraryIsCompiledForThis; \
const bool kLibraryIsCompiledForThis = true; } }\n")
    target_sources(${target} PRIVATE ${check})
  endif()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_link_libraries(${target} PRIVATE ${KINECAL_CERES} Eigen3::Eigen Threads::Threads
                        kinecal_warnings)
  target_include_directories(${target} SYSTEM PRIVATE
    $<TARGET_PROPERTY:Ceres::ceres,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_definitions(${target} PRIVATE
    $<TARGET_PROPERTY:Ceres::ceres,INTERFACE_COMPILE_DEFINITIONS>)
  # g++ 12 takes what AVX-512's own headers leave undefined for a mistake (GCC bug 105593).
  target_compile_options(${target} PRIVATE -march=${level}
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(${target} PRIVATE
    -Wl,-Bsymbolic  # never another object's inline functions
    -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/evaluation.map)
  set_target_properties(${target} PROPERTIES
    LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/evaluation.map
    OUTPUT_NAME kinecal_evaluation
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${folder}
    UNITY_BUILD ON UNITY_BUILD_MODE GROUP
    INSTALL_RPATH_USE_LINK_PATH ON)
  if(KINECAL_INSTALL)
    install(TARGETS ${target} LIBRARY DESTINATION ${folder})
  endif()
endfunction()

if(KINECAL_BUILD_EXAMPLES)
  foreach(level IN LISTS KINECAL_LEVELS)
    kinecal_add_level(${level})
  endforeach()
endif()
