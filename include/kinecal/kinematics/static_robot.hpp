// Lookup of joints and links by name, in a robot that the compiler knows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kinecal/kinematics/robot_data.hpp"

namespace kinecal::detail {

inline constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

/// Index of the joint with this name, or kNowhere.
template <RobotData R>
[[nodiscard]] constexpr std::size_t joint_index(std::string_view name) {
  for (std::size_t i = 0; i < R::kJoints.size(); ++i) {
    if (R::kJoints[i].name == name) return i;
  }
  return kNowhere;
}

/// Index of the joint above a link, or kNowhere.
template <RobotData R>
[[nodiscard]] constexpr std::size_t joint_above(std::string_view link) {
  for (std::size_t i = 0; i < R::kJoints.size(); ++i) {
    if (R::kJoints[i].child == link) return i;
  }
  return kNowhere;
}

/// Number of joints from `base` down to `tip`; kNowhere if `tip` is not below `base`.
template <RobotData R>
[[nodiscard]] constexpr std::size_t depth_below(std::string_view base, std::string_view tip) {
  std::size_t depth = 0;
  for (; tip != base; ++depth) {
    const std::size_t joint = joint_above<R>(tip);
    if (joint == kNowhere) return kNowhere;
    tip = R::kJoints[joint].parent;
  }
  return depth;
}

/// Indices of the last `Depth` joints down to `tip`, from top to bottom.
template <RobotData R, std::size_t Depth>
[[nodiscard]] constexpr std::array<std::size_t, Depth> way_down(std::string_view tip) {
  std::array<std::size_t, Depth> way{};
  for (std::size_t i = Depth; i-- > 0;) {
    way[i] = joint_above<R>(tip);
    tip = R::kJoints[way[i]].parent;
  }
  return way;
}

/// The joint that drives a joint, through all mimic joints in between: see drive().
template <RobotData R>
[[nodiscard]] constexpr MimicData static_drive(std::size_t joint) {
  MimicData result{R::kJoints[joint].name, 1.0, 0.0};
  for (std::size_t n = 0; R::kJoints[joint].mimic && n < R::kJoints.size(); ++n) {
    const MimicData& mimic = *R::kJoints[joint].mimic;
    result = {mimic.joint, result.multiplier * mimic.multiplier,
              result.multiplier * mimic.offset + result.offset};
    joint = joint_index<R>(mimic.joint);
  }
  return result;
}

/// The names of a robot's joints or links, for LookedUp.
template <RobotData R>
struct JointNames {
  static constexpr auto kNames = [] {
    std::array<std::string_view, R::kJoints.size()> names;
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = R::kJoints[i].name;
    return names;
  }();
};
template <RobotData R>
struct LinkNames {
  static constexpr auto kNames = [] {
    std::array<std::string_view, R::kJoints.size() + 1> names = {R::kJoints[0].parent};
    for (std::size_t i = 1; i < names.size(); ++i) names[i] = R::kJoints[i - 1].child;
    return names;
  }();
};

}  // namespace kinecal::detail
