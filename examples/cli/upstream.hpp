// The commands of robot_calibration, and of Fetch's calibrate_robot, as command lines of kinecal.
//
// A link to kinecal that is called calibrate, capture_poses, ... takes the arguments of the program of that name, in ROS 1 and
// in ROS 2.
// Source: robot_calibration, its nodes and README; fetch_calibration, calibrate_robot and launch files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kinecal::cli {

/// What stands for a call of a program of robot_calibration.
struct UpstreamCall {
  std::vector<std::vector<std::string>> lines =
      {};                               ///< arguments of kinecal, run one after another
  std::vector<std::string> notes = {};  ///< what differs, printed before
  std::string urdf = {};                ///< which `init` may write, and then is calibrated
  std::string end = {};                 ///< printed after all of them; may be empty
  bool is_shown = false;                ///< instead of run
};

/// Where it is called.
struct UpstreamPlace {
  std::string date;        ///< for names of files, Y_m_d_H_M_S
  std::string ros_distro;  ///< ROS_DISTRO; empty: not known
  bool is_ros1 = false;    ///< ROS_VERSION is 1
};

/// True for the name of a program that kinecal stands for.
[[nodiscard]] bool is_upstream(std::string_view name);

/// Translates a call.  Reads launch files and files of parameters, and writes nothing.
/// @param name       of the program: "calibrate"
/// @param arguments  as ROS gives them, too: --ros-args, _name:=value, from:=to
/// @throws InputError  naming what it does not take, and the nearest that it does
[[nodiscard]] UpstreamCall translated(const std::string& name,
                                      const std::vector<std::string>& arguments,
                                      const UpstreamPlace& place);

/// Runs the program of this name as upstream's.  If roslaunch has started it, its parameters come from the parameter server,
/// by rosparam.
/// @returns  the exit code of the first line that fails, or 0
int run_as_upstream(const std::string& name, std::vector<std::string> arguments);

}  // namespace kinecal::cli
