// How well readings of a pose repeat, and whether the model explains all the rest: the test for lack of fit.
//
//   sigma_repeats^2 = sum (r - mean of r over the readings of the pose)^2 / (readings - poses)
//   F = ((S - S_repeats) / (freedom - freedom_repeats)) / sigma_repeats^2     S: sum of all squared residuals
//
// If F is larger than chance allows, residuals are errors of the model and not of the sensors: other
// readings of the same poses do not help, but parameters may that the model does not have.
// Source: Draper, Smith, Applied Regression Analysis, 1998, 2.1 (pure error and lack of fit).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal {

/// Sets `repeats` and `repeats_freedom` of the noise of each error block.
/// @param fit    at its solution
/// @param noise  of each error block, by number in the problem
void set_repeats(const LinearFit& fit, const PoseGroups& poses, std::vector<BlockNoise>& noise);

/// True if residuals are larger than readings of a pose repeat: three times, and by more than chance (1e-6).
[[nodiscard]] bool lacks_fit(const BlockNoise& noise);

}  // namespace kinecal
