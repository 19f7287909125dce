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
# library is virtual functions, plain data and matrices of fixed size, which all levels lay out as the baseline does.
# Eigen's matrices of variable size do not: one side would free what the other has allocated in another way.  The
# test no_matrix_crosses looks for them.
# Source: ld.so(8), glibc-hwcaps; x86-64 psABI, micro-architecture levels.

set(KINECAL_LEVELS "")
if(KINECAL_X86_64_LEVELS)
  kinecal_shared_ceres(KINECAL_CERES)
  set(why_not "")
  if(KINECAL_NATIVE OR KINECAL_SANITIZE OR KINECAL_HEADER_ONLY)
    set(why_not "with KINECAL_NATIVE, KINECAL_SANITIZE or KINECAL_HEADER_ONLY")
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
    if(CMAKE_BUILD_TYPE STREQUAL Debug)
      kinecal_link_optimized_first(${program} solve core)
    endif()
    return()
  endif()
  foreach(level IN LISTS KINECAL_LEVELS)
    add_dependencies(${program} kinecal_evaluation_${level})
  endforeach()
  # Before kinecal::io, whose references the static kinecal::solve would resolve otherwise; GNU ld forgets what
  # nobody before it refers to.
  target_link_libraries(${program} PRIVATE
    -Wl,--push-state,--no-as-needed kinecal_evaluation_x86-64 -Wl,--pop-state)
  file(RELATIVE_PATH from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/kinecal)
  set_target_properties(${program} PROPERTIES
    BUILD_RPATH_USE_ORIGIN ON
    INSTALL_RPATH "$ORIGIN/${from_bin}")
endfunction()

# What kinecal_core and kinecal_solve have in them, compiled for one level.
function(kinecal_add_part part library level)
  add_library(${part} OBJECT ${KINECAL_UNITS_${library}})
  target_include_directories(${part} PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_include_directories(${part} SYSTEM PRIVATE
    $<TARGET_PROPERTY:Ceres::ceres,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_definitions(${part} PRIVATE EIGEN_MAX_ALIGN_BYTES=16
    $<TARGET_PROPERTY:Ceres::ceres,INTERFACE_COMPILE_DEFINITIONS>)
  target_compile_features(${part} PRIVATE cxx_std_20)
  target_link_libraries(${part} PRIVATE Eigen3::Eigen Threads::Threads kinecal_warnings)
  # g++ 12 takes what AVX-512's own headers leave undefined for a mistake (GCC bug 105593).
  target_compile_options(${part} PRIVATE -march=${level}
    $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized>)
  set_target_properties(${part} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

function(kinecal_add_level level)
  set(folder ${CMAKE_INSTALL_LIBDIR}/kinecal)
  set(parts kinecal_core kinecal_solve)
  if(NOT level STREQUAL x86-64)
    string(APPEND folder /glibc-hwcaps/${level})
    set(parts kinecal_core_${level} kinecal_solve_${level} kinecal_level_check)
    kinecal_add_part(kinecal_core_${level} core ${level})
    kinecal_add_part(kinecal_solve_${level} solve ${level})
  endif()
  set(target kinecal_evaluation_${level})
  list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  add_library(${target} SHARED ${parts})
  target_link_libraries(${target} PRIVATE ${KINECAL_CERES} Threads::Threads)
  target_link_options(${target} PRIVATE
    -Wl,-Bsymbolic  # never another object's inline functions
    -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/evaluation.map)
  set_target_properties(${target} PROPERTIES
    LINKER_LANGUAGE CXX
    LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/evaluation.map
    OUTPUT_NAME kinecal_evaluation
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${folder}
    INSTALL_RPATH_USE_LINK_PATH ON)
  if(KINECAL_INSTALL)
    install(TARGETS ${target} LIBRARY DESTINATION ${folder} COMPONENT program)
  endif()
endfunction()

# The program is compiled for the baseline and refers to the baseline's checks: see linkage.hpp.
if(KINECAL_BUILD_EXAMPLES AND KINECAL_LEVELS)
  set(check ${CMAKE_CURRENT_BINARY_DIR}/kinecal_level_check.cpp)
  file(CONFIGURE OUTPUT ${check} CONTENT "#include \"kinecal/geometry/eigen_layout.hpp\"
namespace kinecal::KINECAL_INSTRUCTION_SET {
const bool KINECAL_LIBRARY_CHECK = true;
template <>
const bool EigenAligned::KINECAL_LIBRARY_CHECK = true;
}
")
  add_library(kinecal_level_check OBJECT ${check})
  target_include_directories(kinecal_level_check PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_compile_features(kinecal_level_check PRIVATE cxx_std_20)
  target_link_libraries(kinecal_level_check PRIVATE Eigen3::Eigen kinecal_warnings)
  set_target_properties(kinecal_level_check PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()

if(KINECAL_BUILD_EXAMPLES)
  foreach(level IN LISTS KINECAL_LEVELS)
    kinecal_add_level(${level})
  endforeach()
endif()
