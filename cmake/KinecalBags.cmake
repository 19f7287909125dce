# Optional libraries for some bags.  Without one of them kinecal builds, and the error for such a
# bag names the missing library.  Of those that were found
#   KINECAL_BAG_LIBRARIES  has the CMake packages, for kinecalConfig.cmake
#   KINECAL_BAG_FLAGS      has the linker flags, for pkg-config
#   KINECAL_BAG_PACKAGES   has the Debian packages, for the dependencies of our package
set(KINECAL_BAG_LIBRARIES "")
set(KINECAL_BAG_PACKAGES "")
set(KINECAL_BAG_FLAGS "")

function(kinecal_add_bag_library library target debian flag definition bags)
  if(TARGET ${target})
    if(KINECAL_HEADER_ONLY)
      target_link_libraries(kinecal_io INTERFACE ${target})
      target_compile_definitions(kinecal_io INTERFACE ${definition})
    else()
      target_link_libraries(kinecal_io PRIVATE ${target})
      target_compile_definitions(kinecal_io PUBLIC ${definition})
    endif()
    set(KINECAL_BAG_LIBRARIES ${KINECAL_BAG_LIBRARIES} ${library} PARENT_SCOPE)
    set(KINECAL_BAG_PACKAGES ${KINECAL_BAG_PACKAGES} ${debian} PARENT_SCOPE)
    set(KINECAL_BAG_FLAGS "${KINECAL_BAG_FLAGS} ${flag}" PARENT_SCOPE)
  else()
    message(STATUS "kinecal: without ${debian}, ${bags} cannot be read")
  endif()
endfunction()

find_package(BZip2 QUIET)
find_package(SQLite3 QUIET)
pkg_check_modules(liblz4 QUIET IMPORTED_TARGET GLOBAL liblz4)
pkg_check_modules(libzstd QUIET IMPORTED_TARGET GLOBAL libzstd)

kinecal_add_bag_library(BZip2 BZip2::BZip2 libbz2-dev -lbz2 KINECAL_HAVE_BZ2
  "ROS 1 bags compressed with bz2")
kinecal_add_bag_library(liblz4 PkgConfig::liblz4 liblz4-dev -llz4 KINECAL_HAVE_LZ4
  "ROS 1 bags and MCAP files compressed with lz4")
kinecal_add_bag_library(libzstd PkgConfig::libzstd libzstd-dev -lzstd KINECAL_HAVE_ZSTD
  "ROS 2 bags compressed with zstd")
kinecal_add_bag_library(SQLite3 SQLite::SQLite3 libsqlite3-dev -lsqlite3 KINECAL_HAVE_SQLITE
  "ROS 2 bags of .db3 files")
