// Noise that all features of a pose share: joints stop elsewhere than they say.
//
// With rows in standard deviations of the features' own noise, those of a pose are
//
//   r ~ N(0, I + t^2 A A^T)        A: change of r if a joint is off by 1 mrad or 0.2 mm, a column each
//
// What lies outside the columns of A is the features' own noise; along each principal axis u of A A^T, of
// size l, (u r)^2 / (1 - h) = 1 + t^2 l in the mean, h the leverage, so t^2 is the weighted mean of
// ((u r)^2 / (1 - h) - 1) / l.  If A spans all rows of each pose, the two cannot be separated.
//
// The model is simple, so two figures of the whitened residuals say how far to trust it: how much more
// the sums of squares of poses scatter than chi-square, and how much larger their gradients are.
// Source: Searle, Casella, McCulloch, Variance Components, 1992, 5 (weighted analysis of variance);
// Satterthwaite, An Approximate Distribution of Estimates of Variance Components, 1946.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/trust/noise.hpp"
#include "kinecal/trust/pose_groups.hpp"

namespace kinecal {

/// What the residuals of a calibration show of noise that features of a pose share.
struct CommonNoise {
  bool separable = false;  ///< false: each pose has too few features; nothing below is known
  double repeats = 0.0;    ///< t: standard deviation of joints, in mrad and in 0.2 mm
  double freedom = 0.0;    ///< degrees of freedom of t
  double scatter =
      1.0;  ///< variance of the poses' sums of squares over that of chi-square, at least 1
  double effect = 1.0;  ///< variance of the poses' gradients over that of the model, at least 1
};

/// Estimates it.
/// @param fit      of all samples, at its solution
/// @param effects  (rows x joints) see joint_effects()
/// @param noise    of each error block; what is a feature's own is set
[[nodiscard]] CommonNoise common_noise(const LinearFit& fit, const Eigen::MatrixXd& effects,
                                       const PoseGroups& poses, std::vector<BlockNoise>& noise);

}  // namespace kinecal
