// The frames that a problem compares: the uncertainty of their poses is reported and judged.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

namespace kinecal {

/// A frame, and the one in which its pose is given.
struct ComparedFrames {
  FrameOnRobot frame, in;
};

/// The frames of the features that error blocks compare: of the first block with samples, then of the first block of
/// each further camera.  The pose is given in the camera.
/// @param problem  with its samples
/// @returns  empty if no error block has samples, or if each compares a frame with itself
[[nodiscard]] std::vector<ComparedFrames> compared_frames(const AnyProblem& problem,
                                                          std::span<const Sample> samples);

/// The frame of a name: that of a sensor's features, a link, or a virtual frame of the samples.
/// @throws std::invalid_argument  if nothing has the name, with the nearest one
[[nodiscard]] FrameOnRobot frame_named(const AnyProblem& problem, std::span<const Sample> samples,
                                       const std::string& name);

}  // namespace kinecal
