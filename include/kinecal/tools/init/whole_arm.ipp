// The joints of an arm, all of which a table must have: for proposed_joints.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal::detail {

/// Joints with their columns, by index.
using ColumnOfJoint = std::vector<std::pair<std::string, int>>;

/// The driven joints on the way to a link, from the base on.
[[nodiscard]] inline std::vector<std::string> driven_joints(const Robot& robot,
                                                            const std::string& link) {
  std::vector<std::string> names;
  for (const Joint* joint : joints_to_root(robot, link)) {
    if (moves(joint->type) && !joint->mimic) names.insert(names.begin(), joint->name);
  }
  return names;
}

/// Checks that a joint between others of the same arm is not missing: its column has another name.
/// @throws InputError  naming it
inline void check_whole_arm(const Robot& robot, const ColumnOfJoint& found,
                            const std::string& file) {
  const auto is_found = [&](const std::string& joint) {
    return std::any_of(found.begin(), found.end(),
                       [&](const auto& of) { return of.first == joint; });
  };
  for (const std::string& arm : propose_arms(robot)) {
    const std::vector<std::string> joints = driven_joints(robot, arm);
    const auto here = std::count_if(joints.begin(), joints.end(), is_found);
    if (2 * here < std::ssize(joints)) continue;  // another arm
    const auto missing = std::find_if_not(joints.begin(), joints.end(), is_found);
    if (missing == joints.end()) continue;
    throw InputError(
        fmt::format("{}: {} of the {} joints that move '{}' have a column, and '{}' has none; name "
                    "its column like the joint, or say in "
                    "columns.yaml what the columns mean: MANUAL, Samples from a table",
                    file, here, joints.size(), arm, *missing));
  }
}

}  // namespace kinecal::detail
