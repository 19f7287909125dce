// Noise that all features of a pose share: joints stop elsewhere than they say, and the robot is not
// quite as its model.
//
// With rows in standard deviations of the features' own noise, those of a pose are
//
//   r ~ N(0, I + s^2 Q Q^T + w^2 R R^T + t^2 A A^T)
//
// A: change of r if a joint is off by 1 mrad or 0.2 mm, a column each.  Q: axes of a shift of all features of
// an error block alike.  R: axes of what else the joints can do to r, mostly turns of the target.  t is how far
// joints stop elsewhere; s and w are geometry that the model lacks, which errs as much where the joints hardly
// move the features.  What lies outside Q and R is the features' own noise.  If they span all rows of each
// pose, s and w cannot be separated from it: own noise and t remain.
//
// s, w and t reproduce three sums over the calibration's own poses: of squares along Q, of squares along R,
// and of whitened squares.  The means of these sums are of residuals, not of errors: of (I - P) r with
// P = J H^-1 J^T.
//
// The model is simple, so one figure says how far to trust it: how much larger the gradients of poses are.
// Source: Searle, Casella, McCulloch, Variance Components, 1992, 5 (analysis of variance).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal {

/// What the residuals of a calibration show of noise that features of a pose share.
struct CommonNoise {
  bool separable = false;  ///< false: each pose has too few features; s and w are in own noise
  double repeats = 0.0;    ///< t: standard deviation of joints, in mrad and in 0.2 mm
  double shifts = 0.0;     ///< s: of geometry that shifts features, in those of own noise
  double turns = 0.0;      ///< w: of geometry that moves them otherwise, in those of own noise
  double freedom = 0.0;    ///< degrees of freedom of s, w and t
  double effect = 1.0;     ///< variance of the poses' gradients over that of the model, at least 1

  /// True if features of a pose share noise.
  [[nodiscard]] bool is_shared() const { return repeats > 0.0 || shifts > 0.0 || turns > 0.0; }
};

/// Estimates it.
/// @param fit      of all samples, at its solution
/// @param effects  (rows x joints) see joint_effects()
/// @param noise    of each error block; what is a feature's own is set
[[nodiscard]] CommonNoise common_noise(const LinearFit& fit, const Eigen::MatrixXd& effects,
                                       const PoseGroups& poses, std::vector<BlockNoise>& noise);

}  // namespace kinecal
