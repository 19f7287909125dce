// The origins of a robot's joints as YAML: the calibration file of UR's descriptions, that of Franka's, or one with the
// names of the joints.
//
//   kinematics:
//     shoulder:            or the name of a joint
//       x: 0.0             origin of the joint in its parent link, metres
//       y: 0.0
//       z: 0.1625
//       roll: 0.0          radians
//       pitch: 0.0
//       yaw: 0.0001
//     hash: calib_12345    UR only: what the driver compares with the robot's own calibration
//
//   joint1:                Franka, at the top of the file; joint8 is the flange
//     kinematic: {x: 0.0, y: 0.0, z: 0.333, roll: 0.0, pitch: 0.0, yaw: 0.0}
//
// Zeros of joints are turned or slid into the origins: the file has no other place for them.
// Source: Universal_Robots_ROS2_Description, config/ur5e/default_kinematics.yaml; franka_description, robots/fr3/kinematics.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// The first line of what kinematics_yaml() writes: such a file is not a factory's.
inline constexpr std::string_view kKinematicsMark =
    "# Origins of joints in their parent links, metres and radians; zeros of joints are in them.";

/// How a robot differs from such a file: "wrist_1 by 0.3 mm and 0.05 deg, ..."; empty if it does not, so that the URDF was
/// made with the file.
/// @param prefix  of several arms: what the names of this one's joints begin with (tf_prefix of UR)
/// @throws InputError  if it is not such a file
[[nodiscard]] std::string kinematics_difference(const Robot& robot, const std::string& existing,
                                                const std::string& file,
                                                const std::string& prefix = {});

/// The content of such a file, with UR's names if the file is UR's already or the robot has UR's six joints,
/// which rotate about z; with Franka's if the file is Franka's already.
/// @param patches   as patch_urdf() takes them, of joints of the robot
/// @param existing  content of the file that it replaces, whose hash it keeps; empty: absent
/// @param file      its name, for messages
/// @param prefix    as kinematics_difference()
/// @throws InputError  if what exists is not such a file, is UR's or Franka's and the robot is not, or has more than origins; if
///                     several arms could be meant, or none begins with the prefix
[[nodiscard]] std::string kinematics_yaml(const Robot& robot,
                                          const std::vector<JointPatch>& patches,
                                          const std::string& existing, const std::string& file,
                                          const std::string& prefix = {});

/// The first line of what zeros_yaml() writes.
inline constexpr std::string_view kZerosMark = "# Zeros of joints: position = reading + zero.";

/// A list of the zeros of the joints that move, by their names.
/// @param patches  as patch_urdf() takes them
/// @param degrees  and millimetres; else radians and metres
[[nodiscard]] std::string zeros_yaml(const Robot& robot, const std::vector<JointPatch>& patches,
                                     bool degrees);

}  // namespace kinecal
