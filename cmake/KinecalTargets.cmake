# The libraries, one for each set of dependencies:
#   kinecal::core     text ... crate               Eigen, threads
#   kinecal::capture  capture                      core; optional: apriltag, and OpenCV as a plug-in
#   kinecal::solve    solve, trust                 core, Ceres, Boost's headers
#   kinecal::io       study, files ... procedure       capture, solve, urdfdom, libyaml, pugixml, fmt, zlib,
#                                                    nlohmann-json, libcrypto; optional libraries:
#                                                    KinecalOptional.cmake
#   kinecal::kinecal  all of them
#   kinecal::headers  core and solve without their libraries: every source compiles what it includes
include(GNUInstallDirs)

set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # a project that fetches kinecal links them as well

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(urdfdom REQUIRED)
find_package(pugixml REQUIRED)
find_package(fmt REQUIRED)
find_package(ZLIB REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto)
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(libyaml REQUIRED IMPORTED_TARGET GLOBAL yaml-0.1)

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

# Files to compile as translation units: with KINECAL_UNITY so many of them each, else one.  They are included
# relative to a folder, so that a compiler cache knows them in every clone.
# @param result  the variable to set
# @param folder  an include folder that the files are in
function(kinecal_group_sources result name count folder)
  if(NOT KINECAL_UNITY)
    set(count 1)
  endif()
  list(LENGTH ARGN files)
  math(EXPR last "${files} - 1")
  set(units "")
  foreach(first RANGE 0 ${last} ${count})
    list(SUBLIST ARGN ${first} ${count} files)
    list(GET files 0 unit)
    if(NOT files STREQUAL unit OR unit MATCHES "[.]ipp$")
      set(text "")
      foreach(file IN LISTS files)
        cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${folder})
        string(APPEND text "#include \"${file}\"\n")
      endforeach()
      cmake_path(RELATIVE_PATH unit BASE_DIRECTORY ${folder})
      string(REGEX REPLACE "[/.]" "_" unit ${unit})
      set(unit ${CMAKE_CURRENT_BINARY_DIR}/units/${name}/${unit}.cpp)
      file(CONFIGURE OUTPUT ${unit} CONTENT "${text}" @ONLY)
    endif()
    list(APPEND units ${unit})
  endforeach()
  set(${result} ${units} PARENT_SCOPE)
endfunction()

# The translation units of folders: of each .cpp, and each .ipp beside a header of the same name with more than
# templates in it, but with KINECAL_HEADER_ONLY of no .ipp.
# @param result   the variable to set
# @param count    so many sources are one unit with KINECAL_UNITY
# @param alone    sources that are units of their own
# @param options  how they are optimized
# @param ARGN     folders
function(kinecal_add_units result name count alone options)
  set(sources "")
  set(units "")
  foreach(folder IN LISTS ARGN)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${folder}/*.cpp)
    list(FILTER found EXCLUDE REGEX "/capture/opencv/")  # the plug-in: KinecalOpencv.cmake
    list(APPEND sources ${found})
    file(GLOB_RECURSE definitions CONFIGURE_DEPENDS ${folder}/*.ipp)
    foreach(file IN LISTS definitions)
      cmake_path(REPLACE_EXTENSION file hpp OUTPUT_VARIABLE header)
      if(EXISTS ${header} AND NOT KINECAL_HEADER_ONLY)
        file(STRINGS ${file} compiled_once REGEX "KINECAL_INLINE|KINECAL_HEADER_ONLY" LIMIT_COUNT 1)
        if(compiled_once)
          list(APPEND sources ${file})
        endif()
      endif()
    endforeach()
  endforeach()
  foreach(file IN LISTS alone)
    if(file IN_LIST sources)
      list(REMOVE_ITEM sources ${file})
      kinecal_group_sources(unit ${name} 1 ${PROJECT_SOURCE_DIR}/include ${file})
      list(APPEND units ${unit})
    endif()
  endforeach()
  if(sources)
    kinecal_group_sources(grouped ${name} ${count} ${PROJECT_SOURCE_DIR}/include ${sources})
    list(APPEND units ${grouped})
  endif()
  if(units)
    set_source_files_properties(${units} PROPERTIES COMPILE_OPTIONS "${options}")
  endif()
  set(${result} ${units} PARENT_SCOPE)
endfunction()

# kinecal_add_library(<name> FOLDERS <folder>... LINK <target>... [WARM <folder>...] [COLD <folder>...]
#                     [UNIT <count>] [PRIVATE_LINK <target>...] [ALONE <file>...])
#
# FOLDERS       of include/kinecal: their headers and sources
# WARM, COLD    more folders: a release compiles them with -O2 or -O1, not -O3, as a calibration spends
#               little or hardly any of its time in them; a debug build optimizes all but the cold
# ALONE         of these folders: sources that are units of their own with KINECAL_UNITY, too
# UNIT          so many sources are one translation unit with KINECAL_UNITY
# LINK          what the headers include
# PRIVATE_LINK  what only the definitions include
function(kinecal_add_library name)
  cmake_parse_arguments(ARG "" "UNIT" "FOLDERS;WARM;COLD;LINK;PRIVATE_LINK;ALONE" ${ARGN})
  set(target kinecal_${name})
  set(headers "")
  foreach(list FOLDERS WARM COLD ALONE)
    list(TRANSFORM ARG_${list} PREPEND ${PROJECT_SOURCE_DIR}/include/kinecal/)
  endforeach()
  foreach(folder IN LISTS ARG_FOLDERS ARG_WARM ARG_COLD)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${folder}/*.hpp)
    list(APPEND headers ${found} ${folder}.hpp)
  endforeach()
  kinecal_add_units(units ${name} "${ARG_UNIT}" "${ARG_ALONE}" "$<$<CONFIG:Debug>:-O1>" ${ARG_FOLDERS})
  kinecal_add_units(warm ${name} "${ARG_UNIT}" "${ARG_ALONE}"
    "$<$<CONFIG:Debug>:-O1>;$<$<CONFIG:Release>:-O2>" ${ARG_WARM})
  kinecal_add_units(cold ${name} "${ARG_UNIT}" "${ARG_ALONE}" "$<$<CONFIG:Release>:-O1>" ${ARG_COLD})
  list(APPEND units ${warm} ${cold})

  if(NOT units)
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE ${ARG_LINK} ${ARG_PRIVATE_LINK})
  else()
    set(scope PUBLIC)
    add_library(${target} ${units})
    target_link_libraries(${target} PUBLIC ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK}
                          $<BUILD_INTERFACE:kinecal_build_options>)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  set(KINECAL_UNITS_${name} ${units} PARENT_SCOPE)
  add_library(kinecal::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} ${scope} cxx_std_20)
  target_sources(${target} ${scope} FILE_SET HEADERS
                 BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${headers})
  if(KINECAL_INSTALL)
    install(TARGETS ${target} EXPORT kinecal-${name}
            FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT headers)
  endif()
  if(NOT PROJECT_IS_TOP_LEVEL AND NOT KINECAL_INSTALL)
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)  # built where it is linked
  endif()
endfunction()

add_library(kinecal_headers INTERFACE)
add_library(kinecal::headers ALIAS kinecal_headers)
set_target_properties(kinecal_headers PROPERTIES EXPORT_NAME headers)
target_include_directories(kinecal_headers INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(kinecal_headers INTERFACE cxx_std_20)
target_compile_definitions(kinecal_headers INTERFACE KINECAL_HEADER_ONLY)
target_link_libraries(kinecal_headers INTERFACE Eigen3::Eigen Threads::Threads)

set(KINECAL_CORE_FOLDERS text geometry kinematics parameters samples sensors errors problem evaluation
                         crate testing)
kinecal_add_library(core UNIT 16
  ALONE kinematics/pose_batch.ipp evaluation/problem.ipp evaluation/built_in_sensors.ipp evaluation/built_in_blocks.ipp
        evaluation/built_in_base_blocks.ipp evaluation/built_in_pose_blocks.ipp  # these take longest
  FOLDERS ${KINECAL_CORE_FOLDERS} core linkage
  LINK Eigen3::Eigen Threads::Threads)
kinecal_add_library(capture UNIT 30
  FOLDERS capture
  LINK kinecal_core
  PRIVATE_LINK ${CMAKE_DL_LIBS})
# Where it looks for plug-ins: include/kinecal/capture/plugin_file.cpp.
set(plugins ${CMAKE_INSTALL_FULL_LIBDIR}/kinecal)
if(NOT KINECAL_INSTALL)  # fetched by another project, whose programs are anywhere
  set(plugins ${PROJECT_BINARY_DIR}/lib/kinecal)
endif()
file(RELATIVE_PATH plugins_from_program ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/kinecal)
target_compile_definitions(kinecal_capture PRIVATE
  KINECAL_VERSION="${PROJECT_VERSION}"
  KINECAL_PLUGINS="${plugins}"
  KINECAL_PACKAGED_PLUGINS="/usr/${CMAKE_INSTALL_LIBDIR}/kinecal"
  KINECAL_PLUGINS_FROM_PROGRAM="${plugins_from_program}")
kinecal_add_library(solve UNIT 8
  FOLDERS solve
  WARM trust
  LINK kinecal_core Ceres::ceres
  PRIVATE_LINK Boost::headers)
kinecal_add_library(io UNIT 24
  FOLDERS surface  # searched for every point of a cloud
  WARM files study config explain  # large recordings are read, photographs rendered, suspects calibrated
  COLD robots report tools procedure
  LINK kinecal_capture kinecal_solve nlohmann_json::nlohmann_json
  PRIVATE_LINK urdfdom::urdfdom_model PkgConfig::libyaml pugixml::pugixml fmt::fmt ZLIB::ZLIB
               OpenSSL::Crypto Boost::headers)
include(KinecalOptional)
include(KinecalPage)
if(KINECAL_FUZZ)  # what reads files counts which of its branches are taken
  target_compile_options(kinecal_io PRIVATE -fsanitize=fuzzer-no-link)
endif()
if(KINECAL_HEADER_ONLY)
  target_compile_definitions(kinecal_core INTERFACE KINECAL_HEADER_ONLY)
  target_compile_definitions(kinecal_solve PUBLIC KINECAL_LINKS_TRUST)  # the library has trust/ still
endif()
# What links the libraries is compiled and linked as they are.
target_compile_options(kinecal_core INTERFACE $<$<BOOL:${KINECAL_NATIVE}>:-march=native>)
# g++'s address sanitizer changes how Eigen allocates.
target_compile_options(kinecal_core INTERFACE
  $<$<AND:$<BOOL:${KINECAL_SANITIZE}>,$<CXX_COMPILER_ID:GNU>>:-fsanitize=address>)
target_link_options(kinecal_core INTERFACE
  $<$<BOOL:${KINECAL_SANITIZE}>:-fsanitize=address,undefined>)
kinecal_add_library(kinecal
  FOLDERS kinecal
  LINK kinecal_io)

# With shared libraries all of them, and what links them, take one Ceres, a shared one.
if(BUILD_SHARED_LIBS)
  kinecal_shared_ceres(ceres)
  if(ceres)
    set_target_properties(Ceres::ceres PROPERTIES IMPORTED_LOCATION_RELEASE ${ceres}
                          IMPORTED_LOCATION ${ceres})
  endif()
endif()

# kinecal_add_plugin(<name> <source> <component> <target>...)
#
# A part with large dependencies, loaded when it is needed: kinecal/capture/plugin_file.hpp.
# @param component  of the installation
# @param ARGN       what it links
function(kinecal_add_plugin name source component)
  add_library(${name} MODULE ${source})
  set_target_properties(${name} PROPERTIES
    PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/kinecal INSTALL_RPATH_USE_LINK_PATH ON)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_definitions(${name} PRIVATE KINECAL_VERSION="${PROJECT_VERSION}")
  target_link_libraries(${name} PRIVATE ${ARGN})
  if(KINECAL_INSTALL)
    install(TARGETS ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/kinecal COMPONENT ${component})
  endif()
endfunction()

# kinecal_link_optimized_first(<program> <library>...)
#
# Of an inline function the linker takes the first copy that it sees.  In a program that is not optimized it shall be
# that of the libraries, which calibrate.
function(kinecal_link_optimized_first program)
  if(BUILD_SHARED_LIBS OR KINECAL_HEADER_ONLY)
    return()
  endif()
  list(TRANSFORM ARGN REPLACE "(.+)" "$<TARGET_FILE:kinecal_\\1>" OUTPUT_VARIABLE files)
  target_link_options(${program} PRIVATE LINKER:--whole-archive ${files} LINKER:--no-whole-archive)
endfunction()

# Options for kinecal's own programs and tests; users do not get them.
add_library(kinecal_warnings INTERFACE)
target_compile_options(kinecal_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # When it inlines, g++ 12 mistakes "text" + std::string for an overlapping copy (GCC bug 105651), and
  # an empty std::optional for a number that is read (bug 80635).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-maybe-uninitialized>
  $<$<BOOL:${KINECAL_WARNINGS_AS_ERRORS}>:-Werror>
  $<$<BOOL:${KINECAL_NATIVE}>:-march=native>)

# The same with sanitizers.
add_library(kinecal_build_options INTERFACE)
target_link_libraries(kinecal_build_options INTERFACE kinecal_warnings)
target_compile_options(kinecal_build_options INTERFACE
  $<$<BOOL:${KINECAL_SANITIZE}>:-fsanitize=address,undefined;-fno-sanitize-recover=all>
  # These checks double the time to compile; the address sanitizer and the processor find the same.
  $<$<BOOL:${KINECAL_SANITIZE}>:-fno-sanitize=null,alignment,object-size,vptr>
  # Eigen adds offsets to the null pointer of an empty matrix.
  $<$<AND:$<BOOL:${KINECAL_SANITIZE}>,$<CXX_COMPILER_ID:Clang>>:-fno-sanitize=pointer-overflow>
  $<$<BOOL:${KINECAL_SANITIZE}>:-fno-omit-frame-pointer>)
target_link_options(kinecal_build_options INTERFACE
  $<$<BOOL:${KINECAL_SANITIZE}>:-fsanitize=address,undefined>)
