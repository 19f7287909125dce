# kinecal_add_robot(<target> URDF <file> [NAMESPACE <name>])
#
# Adds a library with the robot of a URDF: the build generates a header with the robot as constant
# data, again whenever the URDF changes.
#
#   kinecal_add_robot(fetch URDF urdf/fetch.urdf)
#   target_link_libraries(my_program PRIVATE fetch)
#
#   #include "robots/fetch.hpp"                       // robots/<target>.hpp
#   constexpr auto& joints = fetch::Robot::kJoints;   // <namespace>::Robot, a kinecal::RobotData
#
# URDF       relative to the current source directory; the build itself may generate it
# NAMESPACE  such as `fetch` or `robots::fetch`; by default the robot's name, with `_` in place of
#            everything but letters and digits
#
# kinecal::robot_header, which is built or installed with kinecal, writes the header.  When you
# cross-compile, set KINECAL_ROBOT_HEADER to a kinecal_robot_header that runs on this machine.
function(kinecal_add_robot target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "URDF;NAMESPACE" "")
  set(call "kinecal_add_robot(${target})")
  if(ARG_UNPARSED_ARGUMENTS OR ARG_KEYWORDS_MISSING_VALUES OR NOT ARG_URDF)
    message(FATAL_ERROR "${call}: takes URDF <file> [NAMESPACE <name>], not '${ARGN}'")
  endif()
  cmake_path(ABSOLUTE_PATH ARG_URDF BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
  get_source_file_property(is_generated ${ARG_URDF} GENERATED)
  if(NOT is_generated AND NOT EXISTS ${ARG_URDF})
    message(FATAL_ERROR "${call}: the file ${ARG_URDF} does not exist")
  endif()

  set(program kinecal::robot_header)
  if(KINECAL_ROBOT_HEADER)
    set(program ${KINECAL_ROBOT_HEADER})
  elseif(NOT TARGET ${program})
    message(FATAL_ERROR "${call}: this kinecal was installed without kinecal_robot_header; "
                        "set KINECAL_ROBOT_HEADER to the program")
  endif()

  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}_include)
  set(header ${folder}/robots/${target}.hpp)
  set(name_space "")
  if(ARG_NAMESPACE)
    set(name_space --namespace ${ARG_NAMESPACE})
  endif()
  add_custom_command(OUTPUT ${header}
    COMMAND ${program} --urdf ${ARG_URDF} --output ${header} ${name_space}
    DEPENDS ${ARG_URDF} ${program}
    COMMENT "Generating robots/${target}.hpp"
    VERBATIM)
  add_library(${target} INTERFACE ${header})
  target_sources(${target} INTERFACE FILE_SET HEADERS BASE_DIRS ${folder} FILES ${header})
  target_link_libraries(${target} INTERFACE kinecal::core)
endfunction()
