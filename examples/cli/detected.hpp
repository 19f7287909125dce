// What kinecal detect says of the samples that it found.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::cli {

/// "; 'big' in 16, 'small' in 7" of several targets, by the frames of their features; else empty.
[[nodiscard]] std::string count_of_targets(const std::vector<Sample>& samples);

/// How fast the robot moved, and what a lag does at that speed.
void print_speed(const std::vector<Sample>& samples, const std::optional<Robot>& robot);

/// What the samples lack: photographs that cameras share, and what their lenses need.
/// @param rig  names of several cameras on a body; empty: one camera
void print_lacks(const std::vector<Sample>& samples, const std::vector<std::string>& rig);

}  // namespace kinecal::cli
