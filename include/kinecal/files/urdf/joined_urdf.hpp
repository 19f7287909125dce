// Several robots in one URDF, and each of them alone again.
//
//   <robot name="left_right">
//     <link name="world"/>
//     <joint name="world_left" type="fixed"> ... <origin .../> </joint>      where the robot stands
//     <!-- Robot ur5e. -->
//     <link name="left_base_link"/> ...                                      the robot, as its URDF has it, but for names
//     <joint name="world_right" type="fixed"> ... </joint>
//     ...
//
// Names of links, joints, materials, transmissions, actuators, sensors and <ros2_control> get the robot's name and '_' before
// them.  Names inside <gazebo> stay.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// One of several robots.
struct RobotPart {
  std::string name;  ///< letters, digits, _ and -, a letter first
  std::string text;  ///< of its URDF
  std::string file;  ///< its name, for messages
  std::string folder =
      {};  ///< of relative names of meshes, as seen from the joined URDF; empty: its own
  Vector3<double> xyz = Vector3<double>::Zero();  ///< where it stands in the world, metres
  Vector3<double> rpy =
      Vector3<double>::Zero();  ///< and how it is turned: roll, pitch, yaw, radians
};

/// The link on which all stand.
inline constexpr std::string_view kWorldLink = "world";

/// The joint by which a robot stands in the world: "world_left".
[[nodiscard]] std::string stand_joint(const std::string& robot);

/// The URDF of all.
/// @throws InputError  if a URDF cannot be read, or a name is not possible, occurs twice or begins another one
[[nodiscard]] std::string joined_urdf(std::span<const RobotPart> parts);

/// The names of the robots in such a URDF; empty for any other.
/// @param file  its name, for messages
[[nodiscard]] std::vector<std::string> joined_robots(const std::string& text,
                                                     const std::string& file);

/// One robot of such a URDF alone, under the names that it had.
/// @param name  of joined_robots()
/// @throws InputError  if it is not in the URDF
[[nodiscard]] std::string separated_urdf(const std::string& text, const std::string& file,
                                         const std::string& name);

}  // namespace kinecal
