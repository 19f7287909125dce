// The variance of the gradient of a fit whose features err in groups: joints that do not repeat, a board
// that bends, several readings of one pose.
//
//   S = sum over groups of x x^T,  x = (I - M)^-1/2 g        d = trace S / sum over features of f^T f
//
// with f the gradient of a feature, g their sum in a group, M the group's share of the information, in
// coordinates in which the whole information is the identity.  Independent errors give d = 1; if all n
// features of each group err alike, n.  The factor (I - M)^-1/2 restores what the fit has taken from the
// residuals of an influential group.  S is exact for many groups and noisy for few, so it is shrunk
// towards T, d times the variance of independent features, as far as its own scatter demands:
//
//   w T + (1 - w) S,   w = sum of 2 / n_p / sum of (s_p / t_p - 1)^2, at most 1
//
// over the parameters p, with s_p and t_p their variances by S and by T, and n_p the degrees of freedom of s_p: the
// groups that p depends on (Satterthwaite).  The joint that scatters turns the tracker; a weight of all
// directions alike would take that for noise of S.
//
// Features on the robot's own surface err together by link, too, in all poses alike: a mesh that is not quite the link, a
// drape.  Few poses show nothing of that.  The groups with the larger d count, poses or links.
// Source: Kish, Survey Sampling, 1965, 8.2; Bell, McCaffrey, Bias Reduction in Standard Errors for
// Linear Regression with Multi-Stage Samples, 2002 (CR2); Ledoit, Wolf, A Well-Conditioned Estimator for
// Large-Dimensional Covariance Matrices, 2004.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal {

/// The variance of the gradient of all features, in the coordinates of the fit.
struct GradientVariance {
  Eigen::MatrixXd variance;  ///< (coordinates x coordinates)
  double effect = 1.0;       ///< d: of the parameters' variance over that of independent features
  bool by_links = false;     ///< features of a link err together, more than those of a pose
};

/// The 97.5 % quantile of Student's distribution over that of the normal one.  Its series, four terms from three degrees of
/// freedom; below, from the exact ones of 1 and 2, its logarithm linear in 1 / nu, within 3 %.
/// @param freedom  degrees of freedom nu; below one it counts as one
/// Source: Abramowitz, Stegun, Handbook of Mathematical Functions, 26.7.5.
[[nodiscard]] double student_widening(double freedom);

/// The links on which features lie.
struct FeatureLinks {
  int count = 0;  ///< number of links; zero: no sensor of the problem observes the robot's surface
  /// Of each block of rows: the number of the link of each feature, from 0; empty if it does not observe the surface.
  std::vector<std::vector<int>> of_blocks;
};

/// The links on which features lie, where a sensor stands for the robot's surface (Mount::links).
/// @param samples  those of the problem, in their order
[[nodiscard]] FeatureLinks feature_links(const AnyProblem& problem, const LinearFit& fit,
                                         std::span<const Sample> samples);

/// The variance of the gradient if features of one pose, or of one link, err together.
/// @param poses        of the problem's samples
/// @param independent  (coordinates x coordinates) the variance if all features err independently
/// @param of_priors    (coordinates x coordinates) the share of priors in it
/// @returns  an effect of one unless the groups show more by three standard deviations; of runs, more or less
[[nodiscard]] GradientVariance gradient_variance(const AnyProblem& problem, const LinearFit& fit,
                                                 const PoseGroups& poses, const FeatureLinks& links,
                                                 const Eigen::MatrixXd& independent,
                                                 const Eigen::MatrixXd& of_priors);

}  // namespace kinecal
