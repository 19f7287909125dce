// A joint: it connects a parent link to a child link, as in a URDF.
//
//   parent_T_child(q) = origin * correction * motion(axis, q + offset)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// Types of joints, as in a URDF; chains take all but planar.
enum class JointType {
  fixed,       ///< does not move
  revolute,    ///< rotates about its axis, within limits
  continuous,  ///< rotates about its axis, without limits
  prismatic,   ///< slides along its axis
  floating,    ///< moves freely; its pose is measured, see floating_joint.hpp
  planar       ///< moves in a plane
};

/// The type's name in a URDF.
[[nodiscard]] constexpr std::string_view to_string(JointType type) {
  constexpr std::string_view kNames[] = {"fixed",     "revolute", "continuous",
                                         "prismatic", "floating", "planar"};
  return kNames[static_cast<int>(type)];
}

/// True for joints that rotate: revolute and continuous.
[[nodiscard]] constexpr bool turns(JointType type) {
  return type == JointType::revolute || type == JointType::continuous;
}

/// True for joints with one position: revolute, continuous and prismatic.
[[nodiscard]] constexpr bool moves(JointType type) {
  return turns(type) || type == JointType::prismatic;
}

/// The unit of a position of a joint that moves.
[[nodiscard]] constexpr std::string_view position_unit(JointType type) {
  return turns(type) ? "rad" : "m";
}

/// The position of a mimic joint: multiplier * position(joint) + offset.
struct Mimic {
  std::string joint;        ///< the joint that it follows
  double multiplier = 1.0;  ///< of that joint's position
  double offset = 0.0;      ///< radians or metres
};

/// Range of a joint's position.
struct JointLimits {
  double lower = 0.0;  ///< radians or metres
  double upper = 0.0;  ///< radians or metres
};

/// A joint of a robot.
struct Joint {
  std::string name;                        ///< unique in the robot
  JointType type = JointType::fixed;       ///< how it moves
  std::string parent;                      ///< link
  std::string child;                       ///< link
  Pose<double> origin = {};                ///< of the joint in the parent link, metres
  Vector3<double> axis{1.0, 0.0, 0.0};     ///< unit vector, in the joint's frame
  std::optional<Mimic> mimic = {};         ///< if it follows another joint
  std::optional<JointLimits> limits = {};  ///< if it has any
};

}  // namespace kinecal
