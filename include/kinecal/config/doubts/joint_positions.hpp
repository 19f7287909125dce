// Checks joint positions against the limits of the URDF: degrees, exchanged names, wrong signs,
// absurd numbers.
//
// Robots exceed their limits slightly, by their own offsets: that is a warning.  Positions far
// outside but inside after a conversion, or under another joint's name, have that cause.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// Error: positions in degrees or millimetres, exchanged joints, a number that no joint reaches.
/// Doubt: positions far outside the limits.  Warning: positions slightly outside, or by a turn.
/// @param joints   from used_joints()
/// @param samples  for their source locations
void check_joint_positions(std::span<const UsedJoint> joints, std::span<const Sample> samples,
                           Diagnostics& diagnostics);

/// Doubt: the reading of a joint that moved before is the same in all last samples, while others move.
/// @param joints   from used_joints()
/// @param samples  for their source locations
void check_stopped_joints(std::span<const UsedJoint> joints, std::span<const Sample> samples,
                          Diagnostics& diagnostics);

/// Doubt: a joint never moves although its offset is free.
/// @param config  defines which offsets are free, and where
void check_still_joints(const Config& config, std::span<const UsedJoint> joints,
                        Diagnostics& diagnostics);

}  // namespace kinecal::detail
