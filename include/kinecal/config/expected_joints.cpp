// Definitions of expected_joints.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/expected_joints.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace kinecal {

std::string expected_joints(const Robot& robot, const std::vector<std::string>& names) {
  if (std::any_of(names.begin(), names.end(),
                  [&](const std::string& name) { return robot.has_joint(name); })) {
    return "";
  }
  for (const std::string& name : names) {
    std::vector<std::string> meant;
    for (const std::string& joint : robot.joint_names()) {
      if (joint.ends_with("_" + name)) meant.push_back("'" + joint + "'");
    }
    if (meant.empty()) continue;
    return fmt::format("; the samples have '{}': name joints as the URDF does, {}", name,
                       fmt::join(meant, " or "));
  }
  return "";
}

}  // namespace kinecal
