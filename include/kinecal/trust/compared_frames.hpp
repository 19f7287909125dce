// Which frames a problem compares: what the uncertainty of a pose is stated for, if nobody asks for
// another one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <utility>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/pose_uncertainty.hpp"

namespace kinecal {

/// What the first error block that samples have compares: the frames of its sensors' features.  A camera
/// is the frame in which the other one is wanted, so it comes second.
/// @param problem  with its samples
/// @returns  nullopt if no error block has samples, or it compares nothing with itself
[[nodiscard]] std::optional<std::pair<FrameOnRobot, FrameOnRobot>> compared_frames(
    const AnyProblem& problem, std::span<const Sample> samples);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/trust/compared_frames.ipp"
#endif
