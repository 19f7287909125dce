// The joint and link names of a compile-time robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/robot_data.hpp"

namespace kinecal::detail {

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
