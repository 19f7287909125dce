// Poses for capturing samples, in the YAML of robot_calibration:
//
//   - {joints: [shoulder_pan_joint, ...], positions: [0.1, ...], features: [led_finder]}
//
// `features` names the finders to run there; without it, all finders run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "kinecal/capture/session/capture_pose.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// True if a YAML file contains poses: it is a list, while samples begin with a key.
[[nodiscard]] bool is_poses_yaml(const std::string& path);

/// Reads poses.  Collects all errors; with errors, the poses are incomplete.
/// @param diagnostics  receives errors and warnings, each with "file:line: "
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] std::vector<CapturePose> read_poses_yaml(const std::string& path,
                                                       Diagnostics& diagnostics);

/// Writes poses for read_poses_yaml(), to the last bit of every position.
/// @throws std::invalid_argument  if the numbers of positions and joint names of a pose differ; the
///                                poses before it have then been written
void write_poses_yaml(std::ostream& out, const std::vector<CapturePose>& poses);

}  // namespace kinecal
