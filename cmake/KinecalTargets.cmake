# The libraries, all header-only, one for each set of dependencies:
#   kinecal::core   geometry ... crate           Eigen, threads
#   kinecal::solve  solve, trust                 + Ceres
#   kinecal::io     io, report                   + urdfdom, yaml-cpp, libyaml, pugixml, fmt;
#                                                  what bags need, where it is here: KinecalBags.cmake
#   kinecal::kinecal  all of them
include(GNUInstallDirs)

set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # a project that fetches kinecal links them, too

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED)
find_package(urdfdom REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(pugixml REQUIRED)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(libyaml REQUIRED IMPORTED_TARGET GLOBAL yaml-0.1)

function(kinecal_add_library name)
  cmake_parse_arguments(ARG "" "" "FOLDERS;LINK" ${ARGN})
  add_library(kinecal_${name} INTERFACE)
  add_library(kinecal::${name} ALIAS kinecal_${name})
  set_target_properties(kinecal_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(kinecal_${name} INTERFACE cxx_std_20)
  set(headers "")
  foreach(folder IN LISTS ARG_FOLDERS)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS
         ${PROJECT_SOURCE_DIR}/include/kinecal/${folder}/*.hpp)
    list(APPEND headers ${found} ${PROJECT_SOURCE_DIR}/include/kinecal/${folder}.hpp)
  endforeach()
  target_sources(kinecal_${name} INTERFACE FILE_SET HEADERS
                 BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${headers})
  target_link_libraries(kinecal_${name} INTERFACE ${ARG_LINK})
  install(TARGETS kinecal_${name} EXPORT kinecal-${name}
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

kinecal_add_library(core
  FOLDERS geometry kinematics parameters samples sensors errors crate core
  LINK Eigen3::Eigen Threads::Threads)
kinecal_add_library(solve
  FOLDERS solve trust
  LINK kinecal_core Ceres::ceres)
kinecal_add_library(io
  FOLDERS io report
  LINK kinecal_solve urdfdom::urdfdom_model yaml-cpp PkgConfig::libyaml
       pugixml::pugixml fmt::fmt)
include(KinecalBags)
kinecal_add_library(kinecal
  FOLDERS kinecal
  LINK kinecal_io)

# What kinecal's own programs and tests are built with; never seen by its users.
add_library(kinecal_warnings INTERFACE)
target_compile_options(kinecal_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # g++ 12 takes "text" + std::string for an overlapping copy when it inlines (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${KINECAL_WARNINGS_AS_ERRORS}>:-Werror>
  $<$<BOOL:${KINECAL_NATIVE}>:-march=native>)

# The same with sanitizers: not for examples, which run what the tests run and would take twice as
# long to compile.
add_library(kinecal_build_options INTERFACE)
target_link_libraries(kinecal_build_options INTERFACE kinecal_warnings)
target_compile_options(kinecal_build_options INTERFACE
  $<$<BOOL:${KINECAL_SANITIZE}>:-fsanitize=address,undefined;-fno-sanitize-recover=all>
  # What the address sanitizer and the processor find as well would double the time to compile.
  $<$<BOOL:${KINECAL_SANITIZE}>:-fno-sanitize=null,alignment,object-size,vptr>
  $<$<BOOL:${KINECAL_SANITIZE}>:-fno-omit-frame-pointer>)
target_link_options(kinecal_build_options INTERFACE
  $<$<BOOL:${KINECAL_SANITIZE}>:-fsanitize=address,undefined>)
