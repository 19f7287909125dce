// Poses to capture, from and to bags: messages of CaptureConfig, or of JointState alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/recordings/bag_output.hpp"

namespace kinecal {

/// The poses of a bag of any format, in its order.
/// @param diagnostics  receives every error, also if there are no poses
[[nodiscard]] std::vector<CapturePose> read_bag_poses(const std::string& path,
                                                      Diagnostics& diagnostics);

/// Writes poses for robot_calibration: on calibration_joint_states, one per second.
void write_poses(BagOutput& to, const std::vector<CapturePose>& poses);

}  // namespace kinecal
