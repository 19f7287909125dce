// Cameras of a recording in several files: the first one decides, the others go on with its cameras.
//
//   prepare_cameras(robot, config, first, diagnostics);
//   prepare_later_cameras(robot, config, first, later, diagnostics);   // of each other file
//
// Parameters of a camera are relative to the camera_info of its samples, so all files need the same one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Gives the samples of a later file the camera_info of the first one, where they have none or one with the same
/// intrinsics, and the poses of their targets by these cameras.  A sample in which no camera shows where a target was is
/// left without it, with a note.  Errors: images of another size; no target in any sample, and nothing else to compare.
/// @param robot, config  after prepare_cameras() of the first file's samples
/// @param first          these samples
/// @returns  false after an error
[[nodiscard]] bool prepare_later_cameras(const Robot& robot, const Config& config,
                                         const std::vector<Sample>& first,
                                         std::vector<Sample>& samples, Diagnostics& diagnostics);

}  // namespace kinecal
