// The frames that a problem compares: the uncertainty of a pose is reported for them by default.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

namespace kinecal {

/// The frames compared by the first error block with samples: those of its sensors' features.  A
/// camera comes second, because the other frame's pose is given in the camera.
/// @param problem  with its samples
/// @returns  nullopt if no error block has samples, or if it has only one sensor
[[nodiscard]] std::optional<std::pair<FrameOnRobot, FrameOnRobot>> compared_frames(
    const AnyProblem& problem, std::span<const Sample> samples);

/// The frame of a name: that of a sensor's features, a link, or a virtual frame of the samples.
/// @throws std::invalid_argument  if nothing has the name, with the nearest one
[[nodiscard]] FrameOnRobot frame_named(const AnyProblem& problem, std::span<const Sample> samples,
                                       const std::string& name);

}  // namespace kinecal
