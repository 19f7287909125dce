// The uncertainty of a pose where it was not measured.
//
// Where a camera saw the gripper, it measured the pose itself: the pose is known there even if the
// parameters are not.  A calibration is for other poses:
//
//   J C J^T        at poses without a sample
//   J_i C_i J_i^T  at the pose of sample i, with C_i = (H - A_i^T A_i)^-1 of all other samples,
//                  H = A^T A + priors, A rows in standard deviations of their error block's noise
//
// Source: as pose_uncertainty.hpp; Stone, Cross-Validatory Choice and Assessment of Statistical
// Predictions, 1974, for leaving out each sample once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// The uncertainty of a pose at poses without a sample.
/// @param step    of the problem
/// @param values  of all parameters of the table: the solution
/// @param poses   samples; uses only their joint positions
[[nodiscard]] PoseUncertainty pose_at(const AnyProblem& problem, const Assessment& step,
                                      ParameterValues values, std::span<const Sample> poses,
                                      const FrameOnRobot& frame, const FrameOnRobot& in);

/// The uncertainty of a pose at each sample, from the other samples.
/// @param samples  those of the problem, in their order
[[nodiscard]] PoseUncertainty pose_held_out(const AnyProblem& problem, const Assessment& step,
                                            ParameterValues values, std::span<const Sample> samples,
                                            const FrameOnRobot& frame, const FrameOnRobot& in);

}  // namespace kinecal
