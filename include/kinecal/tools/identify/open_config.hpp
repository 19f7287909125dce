// Configurations that leave open what is free: what a search begins with.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The configuration that samples suggest, as of `kinecal init --from`, without sigmas, which would be guesses.
/// @throws InputError  if they do not name what observes what
[[nodiscard]] Config config_from_samples(const Robot& robot, std::span<const Sample> samples);

/// True if no step frees anything.
[[nodiscard]] bool frees_nothing(const Config& config);

/// Frees the poses that the URDF does not have, such as that of a tracker, in a configuration of one step that frees
/// nothing: those of config_from_samples(), if samples suggest a configuration.  Frames that it fixes stay fixed.
void free_unknown_poses(Config& config, const Robot& robot, std::span<const Sample> samples);

}  // namespace kinecal
