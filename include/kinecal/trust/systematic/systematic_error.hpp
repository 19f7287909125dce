// Systematic errors: what the model does not contain, and what explains the residuals of a fit.
//
// Let joints stand elsewhere than they were measured, or measured points be elsewhere, by one of
//
//   a                   a joint's zero            a (q - mean q)          its gear
//   a sin q + b cos q   once a turn               a sign of the motion from the sample before: backlash
//   a dz/dq             sag: the torque of a weight at the tip
//   a (q_before - q)    all joints: they still had a part of the way to go
//   a x, a (x, y, z)    an axis of a sensor, its scale
//   a (p - c) |p - c|^2 the first term of a lens, around the principal point c
//
// or let a joint, frame or sensor, or the zeros of all joints, have other parameters
//
//   from sample k on, from sample k until sample l, in proportion to the number of the sample
//   in some samples, here and there: those that fit better so, in turn with the parameters
//
// and fit again.  Positions that are multiples of a step u scatter by u / sqrt(12).
//
// Columns X beside those of a fit (J, r, losses W, inverse Hessian C) lower the sum of squares by
//
//   g^T S^-1 g      g = X^T W r      S = X^T W (I - J C J^T W) X
//
// An error is reported if the noise falls far enough (rule_of()) and chance is excluded twice: by the beta distribution
// of the explained share, where a pose counts at most six residuals, over all errors tried; and by draws of the noise that the
// residuals show (common_noise.hpp; 99, down to 19 where rows are many), none of which may explain as much.  A scale that is wrong by a hundredth and
// five standard errors is reported however much noise is left.  Features of a view err together, so a lens is tested by
// fits without each pose in turn.  Errors that move the model's own parameters farther than robots are wrong are ignored.
// Source: Chow, Tests of Equality Between Sets of Coefficients in Two Linear Regressions, 1960; Mooring, Roth, Driels,
// Fundamentals of Manipulator Calibration, 1991; Brown, Decentering Distortion of Lenses, 1966; Westfall, Young,
// Resampling-Based Multiple Testing, 1993.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/common_noise.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"
#include "kinecal/trust/noise/sample_slopes.hpp"

namespace kinecal {

/// What an error depends on.
enum class ErrorCourse {
  zero,      ///< of a joint: everywhere the same
  gear,      ///< its position
  turn,      ///< its position, once a turn
  backlash,  ///< the direction of its motion
  sag,       ///< the torque of a weight at the tip
  lag,       ///< of all joints: the way from the sample before
  rounding,  ///< positions are multiples of a step
  axis,      ///< of a sensor: one coordinate
  scale,     ///< all coordinates
  lens,      ///< the distance from the center of the image
  step,      ///< of parameters: samples from one on
  interval,  ///< samples from one until another
  drift,     ///< the number of the sample
  mixture,   ///< some samples, here and there
};

/// True if parameters change during the recording.
[[nodiscard]] constexpr bool is_change(ErrorCourse course) {
  return course >= ErrorCourse::step;
}

/// An error that explains residuals.
struct SystematicError {
  std::string owner;  ///< joint, sensor, frame or error block; empty: all joints
  ErrorCourse course = ErrorCourse::zero;
  /// Largest error in the samples, radians or metres; backlash: both sides; lag: share of the way; rounding: the step; gear,
  /// axis, scale: true over measured length, minus one; lens: k1; a change: its length in metres, in radians if none has metres.
  double size = 0.0;
  std::vector<int> samples = {};  ///< step, interval, mixture: those with other parameters
  double noise_left = 1.0;        ///< ratio of the noise with the error to that without
  bool refuse = false;            ///< a result with it is not to be used
  std::string text = {};          ///< "with a backlash of 'elbow' of 1 deg"
  std::string advice = {};        ///< what it may be and what to do; may be empty
};

/// "with a backlash of 'elbow' of 1 deg, the noise falls to 40 %; the model does not contain that"
[[nodiscard]] std::string sentence(const SystematicError& error);

/// The error that explains the residuals best; nullopt if none does.
/// @param fitted   samples in the order in which they were recorded; parameters at the solution
/// @param effects  (rows x joints) see joint_effects()
/// @param noise    of each error block; with that of features and of poses (common_noise())
[[nodiscard]] std::optional<SystematicError> systematic_error(const detail::FittedSamples& fitted,
                                                              const PoseGroups& poses,
                                                              const Eigen::MatrixXd& effects,
                                                              const std::vector<BlockNoise>& noise,
                                                              const CommonNoise& common);

}  // namespace kinecal
