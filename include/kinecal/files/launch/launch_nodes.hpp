// Nodes of a launch file of ROS 1, with the arguments and parameters that roslaunch would give them.
//
//   <node pkg="robot_calibration" type="calibrate" name="robot_calibration" args="--manual">
//     <param name="velocity_factor" value="$(arg velocity_factor)"/>
//     <rosparam file="$(find fetch_calibration)/config/capture.yaml" command="load"/>
//   </node>
//
// Known are <arg>, <group>, <param>, <rosparam> and <node>, if= and unless=, $(arg), $(find), $(env), $(optenv), $(dirname).
// Nothing is run, and included files are not read.
// Source: ROS wiki, roslaunch/XML.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// A node that a launch file starts.
struct LaunchNode {
  std::string package, type;
  std::string name;                               ///< full, without a leading slash
  std::vector<std::string> arguments;             ///< of the program
  std::map<std::string, std::string> parameters;  ///< private ones with a value, by name
  std::vector<std::string> parameter_files;       ///< loaded into its namespace, in their order
  std::map<std::string, std::string> remaps;      ///< names of topics, from and to
  SourceLocation place;
};

/// What is used of a launch file.
struct LaunchNodes {
  std::vector<LaunchNode> nodes;      ///< of the wanted packages
  std::string robot_description;      ///< file of this parameter; empty if it has none
  std::vector<std::string> included;  ///< as the file writes them
};

/// Reads the nodes of some packages; what belongs to others is not looked at.
/// @param given        values of arguments: name:=value of roslaunch
/// @param packages     whose nodes are wanted
/// @param diagnostics  receives errors
/// @throws InputError  if the file cannot be read or is not a launch file
[[nodiscard]] LaunchNodes read_launch_nodes(const std::string& path,
                                            const std::map<std::string, std::string>& given,
                                            const std::vector<std::string>& packages,
                                            Diagnostics& diagnostics);

}  // namespace kinecal
