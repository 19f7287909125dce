# Puts kinecal in the place of robot_calibration in this shell; read it after the setup.bash of your workspace:
#   source /usr/lib/kinecal/robot_calibration/setup.bash
kinecal_prefix=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export PATH="$kinecal_prefix/bin:$PATH"
export AMENT_PREFIX_PATH="$kinecal_prefix${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}"
export CMAKE_PREFIX_PATH="$kinecal_prefix${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}"
export ROS_PACKAGE_PATH="$kinecal_prefix/share${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}"
unset kinecal_prefix
