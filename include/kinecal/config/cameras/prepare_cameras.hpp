// What a configuration and its samples leave open about cameras, and poses of samples: between reading and assemble().
//
//   config = parse_config(...);  samples = read_samples(...);  robot = read_urdf(...);
//   if (prepare_cameras(robot, config, samples, diagnostics)) assemble(config, robot, samples, diagnostics);
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Gives the robot the frames with a pose of their own in each sample (with_own_frames()), finds lenses and where the
/// cameras start (find_lenses(), start_cameras()), and decides what is not said of lenses and images (choose_lenses(),
/// choose_images()).
/// @returns  false after an error without which the other checks of a configuration would only repeat it
[[nodiscard]] bool prepare_cameras(Robot& robot, Config& config, std::vector<Sample>& samples,
                                   Diagnostics& diagnostics);

}  // namespace kinecal
