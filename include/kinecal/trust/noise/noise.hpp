// The noise of each error block, from the residuals of a fit.
//
//   sigma^2 = sum r^2 / (rows - leverage)        leverage = trace of J H^-1 J^T over the block's rows
//
// and robustly from the median of the features' distances, which a few bad captures do not affect.
// Source: Press et al., Numerical Recipes, 15.6; Rousseeuw, Leroy, Robust Regression, 1987, 1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal {

/// The noise of one error block.
struct BlockNoise {
  std::string block;             ///< name of the error block
  std::string unit;              ///< of the residual: "m", "px" or "1"
  std::int64_t features = 0;     ///< compared features
  int components = 1;            ///< residuals of a feature
  double freedom = 0.0;          ///< rows minus those that parameters use up
  double given = 0.0;            ///< sigma of the configuration, in `unit`; 0: none
  double sigma = 0.0;            ///< standard deviation of a residual component, in `unit`
  double robust = 0.0;           ///< the same from the median
  double along = 0.0;            ///< robust, in the direction of the largest scatter, in `unit`
  double across = 0.0;           ///< the same in that of the second largest; 0: not computed
  double own = 0.0;              ///< sigma without what features of a pose share; 0: not known
  double own_freedom = 0.0;      ///< degrees of freedom of `own`
  double repeats = 0.0;          ///< sigma among readings of a pose, in `unit`; 0: not known
  double repeats_freedom = 0.0;  ///< its degrees of freedom
  double unit_sigma = 1.0;       ///< residual in `unit` of a weighted residual of one
  double distance = 0.0;         ///< rms of poses, robust, metres; 0: the block compares no poses
  double angle = 0.0;            ///< the same of their rotations, radians

  /// Standard deviation of a weighted residual component: 1 if the given sigma is right.
  [[nodiscard]] double weighted() const { return sigma / unit_sigma; }
  /// Standard deviation of what a feature does not share with others of its pose, in `unit`.
  [[nodiscard]] double own_or_all() const { return own > 0.0 ? own : sigma; }
  /// Its degrees of freedom.
  [[nodiscard]] double own_freedom_or_all() const { return own > 0.0 ? own_freedom : freedom; }
};

namespace detail {
/// Ratio of the tail of the distances to that of isotropic noise: a depth camera's noise is along
/// its rays and grows with distance.  Uses the 95 % quantile; at most the value of noise in one
/// direction of three.
/// @param sigma  robust_sigma() of the same distances
[[nodiscard]] double tail_factor(std::vector<double> distances, int components, double sigma);

/// The noise of one error block from sums over its features.
/// @param squares   sum of the squared weighted residuals, with their losses
/// @param leverage  trace of J H^-1 J^T
/// @param robust    standard deviation of the weighted residuals: see robust_sigma()
[[nodiscard]] BlockNoise block_noise(const Term& term, std::int64_t features, double squares,
                                     double leverage, double robust);
}  // namespace detail

/// The noise of each error block of a problem.
/// @param inverse  (coordinates x coordinates) of the information
[[nodiscard]] std::vector<BlockNoise> estimate_noise(const AnyProblem& problem,
                                                     const LinearFit& fit,
                                                     const Eigen::MatrixXd& inverse);

/// The noise of each error block at a solution.
/// @param values  of all parameters of the table
/// @throws std::domain_error  if a residual is undefined there
[[nodiscard]] std::vector<BlockNoise> noise_at(const AnyProblem& problem, const FreeSet& free,
                                               ParameterValues values);

/// Variance of the weighted residuals of priors: 1 if weights are one over standard deviations,
/// else that of all error blocks.
[[nodiscard]] double prior_variance(const std::vector<BlockNoise>& noise);

namespace detail {
/// Sets `distance` and `angle` of noise of poses.  Each is the smaller of two estimates, of all features and from the
/// median, so that a few bad captures do not count.
/// @param residuals  (6 x features) weighted
void set_pose_errors(const Term& term, const Eigen::MatrixXd& residuals, BlockNoise& noise);

/// Sets `along` and `across` of noise whose features have two or three components.
/// @param residuals  (components x features) weighted
void set_directions(const Eigen::MatrixXd& residuals, BlockNoise& noise);
}  // namespace detail

/// Standard deviation of the components, from the median of the distances of features.
/// @param distances   norm of each feature's residual
/// @param components  residuals of a feature
[[nodiscard]] double robust_sigma(std::vector<double> distances, int components);

}  // namespace kinecal
