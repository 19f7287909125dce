// Poses in which samples are to be captured, in the YAML of robot_calibration:
//
//   - {joints: [shoulder_pan_joint, ...], positions: [0.1, ...], features: [led_finder]}
//
// `features` names the finders that look for features there; without it, all finders do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "kinecal/capture/capture_pose.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// True if a YAML file holds poses: it is a list, while samples begin with a key.
[[nodiscard]] bool is_poses_yaml(const std::string& path);

/// Reads poses.  All errors are collected; with errors the poses are incomplete.
/// @param diagnostics  receives errors and warnings, each with "file:line: "
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] std::vector<CapturePose> read_poses_yaml(const std::string& path,
                                                       Diagnostics& diagnostics);

/// Writes poses as read_poses_yaml() reads them, to the last bit of every position.
/// @throws std::invalid_argument  if a pose has more or fewer positions than joint names; the poses
///                                before it have then been written
void write_poses_yaml(std::ostream& out, const std::vector<CapturePose>& poses);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/poses/poses.ipp"
#endif
