// Judging the noise of error blocks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <string>

#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/plausible_change.hpp"

namespace kinecal::detail {

/// A larger sigma was given in the wrong unit, if the noise is far below it.
[[nodiscard]] double most_sigma(const std::string& unit);

/// Limits of the distance of a feature, in `unit`; those in metres shrink with a robot smaller than a metre.
[[nodiscard]] Limits distance_limits(const std::string& unit, double size);

/// Limits of the difference of two poses' rotations, radians: markers are seen to a degree, in a bad light to two.
inline constexpr Limits kPoseAngles{2.0 * std::numbers::pi / 180.0, 6.0 * std::numbers::pi / 180.0};

/// Poses without a sigma: their distances have the limits of points, their angles kPoseAngles.
/// @param size  of the robot, metres
void judge_poses(const BlockNoise& noise, double size, Judgement& judgement);

/// A sigma is a claim about residuals.  They may be larger because the model is not as good as the sensors: that
/// is no reason to refuse a fit that is good enough without a sigma.
[[nodiscard]] Grade grade_of_sigma(double times, double distance, const Limits& distances);

/// Noise of one direction: a sensor that is bad in one axis, or joints that do not repeat.
void judge_directions(const Assessment& step, Judgement& judgement);

void judge_noise(const Assessment& step, Judgement& judgement);

/// True if the residuals of a step speak against no sigma, and are as small as those of good sensors:
/// joints under wrong names or with wrong signs do not fit so.
[[nodiscard]] bool fits_to_noise(const Assessment& step);

}  // namespace kinecal::detail
