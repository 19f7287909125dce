// Residuals with a pattern that the model does not contain: the gear of a joint, an eccentric encoder, backlash,
// sag, samples taken before the robot stood, a sensor whose axis has another scale.
//
// Let the joints stand elsewhere than they were measured, or a sensor's axis be longer, by one of
//
//   a                   a joint's zero            a (q - mean q)          its gear
//   a sin q + b cos q   once a turn               a sign of the motion from the sample before: backlash
//   a dz/dq             sag: the torque of a weight at the tip
//   a (q_before - q)    all joints: they still had a part of the way to go
//   a x                 an axis of a sensor
//   a (x, y, z)         its scale
//
// and fit again.  Positions that are multiples of a step u scatter by u / sqrt(12).  A pattern is reported if chance is excluded over all of them, and if the noise falls to 75 %; a scale
// also if it is wrong by a hundredth and five standard errors, however much noise is left: noise is no argument for it.
// Source: Mooring, Roth, Driels, Fundamentals of Manipulator Calibration, 1991, for the errors of joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/pose_groups.hpp"

namespace kinecal {

/// What an error depends on.
enum class ErrorCourse { zero, gear, turn, backlash, sag, lag, axis, scale, rounding };

/// An error that explains residuals.
struct ResidualPattern {
  std::string owner;                       ///< joint or sensor; empty: all joints
  ErrorCourse course = ErrorCourse::zero;  ///< of the error
  double size = 0.0;    ///< largest error in the samples, radians or metres; backlash: both sides;
                        ///< lag: share of the way; rounding: the step of the positions
  double factor = 1.0;  ///< gear: true over measured motion; axis, scale: true over measured length
  int axis = 0;         ///< of a sensor: 0, 1, 2
  bool turns = true;    ///< size in radians, not metres
  double noise_left = 1.0;  ///< ratio of the noise with the error to that without
};

/// The pattern that explains the residuals best; nullopt if none does.
/// @param free     the parameters of `fit`, at its solution
/// @param values   of all parameters of the table: the solution
/// @param samples  those of the problem, in the order in which they were recorded
/// @param effects  (rows x joints) see joint_effects()
[[nodiscard]] std::optional<ResidualPattern> residual_pattern(
    const AnyProblem& problem, const FreeSet& free, const LinearFit& fit, ParameterValues values,
    std::span<const Sample> samples, const PoseGroups& poses, const Eigen::MatrixXd& effects);

}  // namespace kinecal
