# Optional libraries: for some bags, images and boards.  Without one of them kinecal
# builds, and the error for what needs it names the missing library.  Of those that were found
#   KINECAL_OPTIONAL_<target>_LIBRARIES  has the CMake packages, for kinecalConfig.cmake
#   KINECAL_OPTIONAL_<target>_FLAGS      has the linker flags, for pkg-config
#   KINECAL_OPTIONAL_PACKAGES            has the Debian packages, for the dependencies of our package
# of kinecal's own target capture or io.
set(KINECAL_OPTIONAL_PACKAGES "")

# kinecal_add_optional(<kinecal's target> <CMake package or name for pkg-config> TARGETS <target>...
#                      DEBIAN <package> FLAGS <linker flags> DEFINE <macro> FOR <what needs it>)
function(kinecal_add_optional user library)
  cmake_parse_arguments(ARG "" "DEBIAN;FLAGS;DEFINE;FOR" "TARGETS" ${ARGN})
  foreach(target IN LISTS ARG_TARGETS)
    if(NOT TARGET ${target})
      message(STATUS "kinecal: without ${ARG_DEBIAN}, no ${ARG_FOR}")
      return()
    endif()
  endforeach()
  target_link_libraries(kinecal_${user} PRIVATE ${ARG_TARGETS})
  target_compile_definitions(kinecal_${user} PUBLIC ${ARG_DEFINE})
  set(prefix KINECAL_OPTIONAL_${user})
  set(libraries ${${prefix}_LIBRARIES} ${library})
  set(packages ${KINECAL_OPTIONAL_PACKAGES} ${ARG_DEBIAN})
  list(REMOVE_DUPLICATES libraries)
  list(REMOVE_DUPLICATES packages)
  set(${prefix}_LIBRARIES ${libraries} PARENT_SCOPE)
  set(${prefix}_FLAGS "${${prefix}_FLAGS} ${ARG_FLAGS}" PARENT_SCOPE)
  set(KINECAL_OPTIONAL_PACKAGES ${packages} PARENT_SCOPE)
endfunction()

find_package(apriltag QUIET)
kinecal_add_optional(capture apriltag TARGETS apriltag::apriltag DEBIAN libapriltag-dev
  FLAGS -lapriltag DEFINE KINECAL_HAVE_APRILTAG FOR "AprilTags")
kinecal_add_optional(io apriltag TARGETS apriltag::apriltag DEBIAN libapriltag-dev
  FLAGS -lapriltag DEFINE KINECAL_HAVE_APRILTAG FOR "AprilTags")
find_package(BZip2 QUIET)
find_package(SQLite3 QUIET)
find_package(PNG QUIET)
find_package(JPEG QUIET)
find_package(TIFF QUIET)
pkg_check_modules(liblz4 QUIET IMPORTED_TARGET GLOBAL liblz4)
pkg_check_modules(libzstd QUIET IMPORTED_TARGET GLOBAL libzstd)
kinecal_add_optional(io BZip2 TARGETS BZip2::BZip2 DEBIAN libbz2-dev
  FLAGS -lbz2 DEFINE KINECAL_HAVE_BZ2 FOR "ROS 1 bags compressed with bz2")
kinecal_add_optional(io liblz4 TARGETS PkgConfig::liblz4 DEBIAN liblz4-dev
  FLAGS -llz4 DEFINE KINECAL_HAVE_LZ4 FOR "ROS 1 bags and MCAP files compressed with lz4")
kinecal_add_optional(io libzstd TARGETS PkgConfig::libzstd DEBIAN libzstd-dev
  FLAGS -lzstd DEFINE KINECAL_HAVE_ZSTD FOR "ROS 2 bags compressed with zstd")
kinecal_add_optional(io SQLite3 TARGETS SQLite::SQLite3 DEBIAN libsqlite3-dev
  FLAGS -lsqlite3 DEFINE KINECAL_HAVE_SQLITE FOR "ROS 2 bags of .db3 files and the history of watch")
kinecal_add_optional(io PNG TARGETS PNG::PNG DEBIAN libpng-dev
  FLAGS -lpng DEFINE KINECAL_HAVE_PNG FOR "PNG images")
kinecal_add_optional(io JPEG TARGETS JPEG::JPEG DEBIAN libjpeg-dev
  FLAGS -ljpeg DEFINE KINECAL_HAVE_JPEG FOR "JPEG images")
kinecal_add_optional(io TIFF TARGETS TIFF::TIFF DEBIAN libtiff-dev
  FLAGS -ltiff DEFINE KINECAL_HAVE_TIFF FOR "TIFF images")
