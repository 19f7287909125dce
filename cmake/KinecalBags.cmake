# Libraries that some bags need.  kinecal builds without each of them, and then says of such a bag
# what is missing.  Of those that were found
#   KINECAL_BAG_LIBRARIES  is for kinecalConfig.cmake to find again
#   KINECAL_BAG_PACKAGES   what they are called in Debian, is for the package to depend on
set(KINECAL_BAG_LIBRARIES "")
set(KINECAL_BAG_PACKAGES "")

function(kinecal_add_bag_library library target debian definition bags)
  if(TARGET ${target})
    target_link_libraries(kinecal_io INTERFACE ${target})
    target_compile_definitions(kinecal_io INTERFACE ${definition})
    set(KINECAL_BAG_LIBRARIES ${KINECAL_BAG_LIBRARIES} ${library} PARENT_SCOPE)
    set(KINECAL_BAG_PACKAGES ${KINECAL_BAG_PACKAGES} ${debian} PARENT_SCOPE)
  else()
    message(STATUS "kinecal: without ${debian}, ${bags} cannot be read")
  endif()
endfunction()

find_package(BZip2 QUIET)
find_package(SQLite3 QUIET)
pkg_check_modules(liblz4 QUIET IMPORTED_TARGET GLOBAL liblz4)
pkg_check_modules(libzstd QUIET IMPORTED_TARGET GLOBAL libzstd)

kinecal_add_bag_library(BZip2 BZip2::BZip2 libbz2-dev KINECAL_HAVE_BZ2
  "ROS 1 bags compressed with bz2")
kinecal_add_bag_library(liblz4 PkgConfig::liblz4 liblz4-dev KINECAL_HAVE_LZ4
  "ROS 1 bags and MCAP files compressed with lz4")
kinecal_add_bag_library(libzstd PkgConfig::libzstd libzstd-dev KINECAL_HAVE_ZSTD
  "ROS 2 bags compressed with zstd")
kinecal_add_bag_library(SQLite3 SQLite::SQLite3 libsqlite3-dev KINECAL_HAVE_SQLITE
  "ROS 2 bags of .db3 files")
