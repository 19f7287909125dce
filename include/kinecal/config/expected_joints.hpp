// How joints should be called where samples leave out the prefix of one of several arms.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// "; the samples have 'elbow': name joints as the URDF does, 'left_elbow' or 'right_elbow'"; empty if a name is that of a
/// joint, or no joint ends in one.
/// @param names  of joints in a sample
[[nodiscard]] std::string expected_joints(const Robot& robot,
                                          const std::vector<std::string>& names);

}  // namespace kinecal
