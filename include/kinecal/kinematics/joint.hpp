// A joint: what connects a parent link to a child link, with the URDF's meaning.
//
//   parent_T_child(q) = origin * correction * motion(axis, q + offset)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "kinecal/geometry/pose.hpp"

namespace kinecal {

enum class JointType { fixed, revolute, continuous, prismatic, floating, planar };

[[nodiscard]] constexpr std::string_view to_string(JointType type) {
  constexpr std::string_view kNames[] = {"fixed",     "revolute", "continuous",
                                         "prismatic", "floating", "planar"};
  return kNames[static_cast<int>(type)];
}

[[nodiscard]] constexpr bool turns(JointType type) {
  return type == JointType::revolute || type == JointType::continuous;
}

/// True for joints with one position: revolute, continuous and prismatic.
[[nodiscard]] constexpr bool moves(JointType type) {
  return turns(type) || type == JointType::prismatic;
}

/// The position of a mimic joint: multiplier * position(joint) + offset.
struct Mimic {
  std::string joint;
  double multiplier = 1.0;
  double offset = 0.0;  ///< radians or metres
};

struct JointLimits {
  double lower = 0.0, upper = 0.0;  ///< radians or metres
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  std::string parent, child;                        ///< links
  Pose<double> origin;                              ///< of the joint in the parent link, metres
  Vector3<double> axis{1.0, 0.0, 0.0};            ///< unit vector, in the joint's frame
  std::optional<Mimic> mimic = {};
  std::optional<JointLimits> limits = {};
};

}  // namespace kinecal
