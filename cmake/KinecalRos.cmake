# Where ROS looks for programs: `ros2 run kinecal kinecal`, `rosrun kinecal kinecal`; and, in a prefix of its own, the programs
# of robot_calibration as links to kinecal (examples/cli/upstream.hpp):
#   lib/kinecal/robot_calibration/setup.bash                 puts the prefix before others
#   lib/kinecal/robot_calibration/lib/robot_calibration/     calibrate, capture_poses, ...
#   lib/kinecal/robot_calibration/bin/calibrate_robot        as Fetch has it
# Source: REP 122; ament_index_cpp; catkin_find and rosrun of ROS 1.

# A link, by default to the program.
function(kinecal_install_link name folder component)
  set(target ${ARGN})
  if(NOT target)
    file(RELATIVE_PATH target /${folder} /${CMAKE_INSTALL_BINDIR}/kinecal)
  endif()
  set(link ${PROJECT_BINARY_DIR}/links/${folder}/${name})
  cmake_path(GET link PARENT_PATH links)
  file(MAKE_DIRECTORY ${links})
  file(CREATE_LINK ${target} ${link} SYMBOLIC)
  install(FILES ${link} DESTINATION ${folder} COMPONENT ${component})
endfunction()

# By which ROS 2 knows a package.
function(kinecal_install_ament_marker package prefix component)
  file(TOUCH ${PROJECT_BINARY_DIR}/links/${package})
  install(FILES ${PROJECT_BINARY_DIR}/links/${package} COMPONENT ${component}
          DESTINATION ${prefix}${CMAKE_INSTALL_DATADIR}/ament_index/resource_index/packages)
endfunction()

kinecal_install_link(kinecal lib/kinecal program)
kinecal_install_ament_marker(kinecal "" program)
install(FILES ${PROJECT_SOURCE_DIR}/package.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/kinecal COMPONENT program)

set(prefix lib/kinecal/robot_calibration/)
foreach(name calibrate capture_poses viz to_rpy base_calibration base_calibration_node calibrate_base
             magnetometer_calibration calibrate_robot)
  kinecal_install_link(${name} ${prefix}lib/robot_calibration robot_calibration)
endforeach()
kinecal_install_link(calibrate_robot ${prefix}bin robot_calibration)
kinecal_install_link(kinecal-robot-calibration ${CMAKE_INSTALL_DATADIR}/doc robot_calibration kinecal)
kinecal_install_ament_marker(robot_calibration ${prefix} robot_calibration)
configure_file(${PROJECT_SOURCE_DIR}/cmake/package/robot_calibration/package.xml.in
  ${PROJECT_BINARY_DIR}/package/robot_calibration/package.xml @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/package/robot_calibration/package.xml
        DESTINATION ${prefix}share/robot_calibration COMPONENT robot_calibration)
file(TOUCH ${PROJECT_BINARY_DIR}/package/robot_calibration/.catkin)  # by which ROS 1 knows a prefix
install(FILES ${PROJECT_BINARY_DIR}/package/robot_calibration/.catkin
              ${PROJECT_SOURCE_DIR}/cmake/package/robot_calibration/setup.bash
        DESTINATION ${prefix} COMPONENT robot_calibration)
