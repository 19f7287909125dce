# One program for every x86-64 processor, each at its best.
#
# The evaluation holds as many samples at once as the instruction set it is compiled for has lanes.
# So what evaluates is compiled once for each level, into shared libraries of one name:
#   lib/kinecal/lib<library>.so                            any x86-64
#   lib/kinecal/glibc-hwcaps/x86-64-v3/lib<library>.so     AVX2
#   lib/kinecal/glibc-hwcaps/x86-64-v4/lib<library>.so     AVX-512
# and the dynamic loader takes the best that the processor has (glibc 2.33; older ones the first).
# Objects for different levels must not meet in one file: their inline functions bear the same
# names, and the linker would take one of them for all.  That holds for a static Ceres, too, which is
# compiled for the baseline: its shared library is taken instead.
# Source: ld.so(8), glibc-hwcaps; x86-64 psABI, micro-architecture levels.

# The shared library of Ceres, empty if there is none: Debian's package has both, and names the
# static one.
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

# Links a program with a library of sources (an INTERFACE library), once for each level or directly.
function(kinecal_link_levels program library)
  if(NOT KINECAL_LEVELS)
    target_link_libraries(${program} PRIVATE ${library})
    return()
  endif()
  foreach(level IN LISTS KINECAL_LEVELS)
    set(folder ${CMAKE_INSTALL_LIBDIR}/kinecal)
    if(NOT level STREQUAL x86-64)
      string(APPEND folder /glibc-hwcaps/${level})
    endif()
    set(target ${library}_${level})
    add_library(${target} SHARED)
    target_link_libraries(${target} PRIVATE ${KINECAL_CERES} ${library})
    # g++ 12 takes what AVX-512's own headers leave undefined for a mistake (GCC bug 105593).
    target_compile_options(${target} PRIVATE -march=${level}
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(${target} PRIVATE -Wl,-Bsymbolic)  # never another object's inline functions
    set_target_properties(${target} PROPERTIES
      OUTPUT_NAME ${library}
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${folder}
      CXX_VISIBILITY_PRESET hidden
      VISIBILITY_INLINES_HIDDEN ON
      INSTALL_RPATH_USE_LINK_PATH ON)
    install(TARGETS ${target} LIBRARY DESTINATION ${folder})
    add_dependencies(${program} ${target})
  endforeach()
  target_link_libraries(${program} PRIVATE ${library}_x86-64)
  file(RELATIVE_PATH from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/kinecal)
  set_target_properties(${program} PROPERTIES
    BUILD_RPATH_USE_ORIGIN ON
    INSTALL_RPATH "$ORIGIN/${from_bin}")
endfunction()
