// Frames with a pose of their own in each sample: a board that a person holds, an object that was moved.
//
//   per_sample: [board]
//
// A fixed joint of the robot of that name becomes a floating one.  A frame that the robot does not have, in which
// features of a model are, becomes a floating joint between the link of that model and a new link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The robot with a floating joint for each frame of `per_sample`; the models whose features are in such a frame get its
/// link.  Errors: a frame that is neither a joint nor one of recorded features; a joint that moves; a
/// frame that is free in a step, too.
[[nodiscard]] Robot with_own_frames(const Robot& robot, Config& config,
                                    std::span<const Sample> samples, Diagnostics& diagnostics);

/// The URDF of cameras without a robot: each link of a model that is not the base stands on the base by a fixed joint,
/// "<link>_joint", or, where `per_sample` names the link, by a floating one of that name.
[[nodiscard]] std::string urdf_of_cameras(const Config& config);

}  // namespace kinecal
