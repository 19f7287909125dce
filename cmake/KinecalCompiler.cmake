# Faster builds of this tree, by what is installed: ccache, the linker lld, memory for g++.  Of what is
# missing, one line says what it costs.

# Unchanged sources are not compiled again, in other build folders and other clones either: paths are
# relative to the tree, and debug information may name another clone.  Nor is what another preset has compiled
# with the same options: that a warning is an error is none of them.
find_program(KINECAL_CCACHE ccache)
if(NOT KINECAL_CCACHE)
  message(STATUS "kinecal: without ccache, each build folder compiles everything")
elseif(NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=true CCACHE_IGNOREOPTIONS=-Werror CCACHE_MAXSIZE=10G ${KINECAL_CCACHE})
endif()

# A release is linked as on machines without lld.
if(CMAKE_BUILD_TYPE STREQUAL Debug)
  include(CheckLinkerFlag)
  check_linker_flag(CXX -fuse-ld=lld KINECAL_HAS_LLD)
  if(KINECAL_HAS_LLD)
    add_link_options(-fuse-ld=lld)
  else()
    message(STATUS "kinecal: without lld, linking takes longer")
  endif()
endif()

# g++ collects garbage from 1 GB on, not from some 100 MB: a fifth of its time.
add_compile_options($<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1048576>)
