// The covariance of the parameters at the solution, from the noise of the residuals.
//
//   C = H^-1 V H^-1      H = sum w^2 J^T J + P      V = sum s_b^2 w^2 J^T J + s^2 P
//
// with P the priors, s_b the weighted noise of error block b, and s = 1 if all blocks have a sigma,
// else that of all blocks: without sigmas, weights are only ratios.  One common s gives s^2 H^-1.
// What a prior shifts that the samples contradict is in V, too (prior_pulls.hpp).
// With robust losses it is the sandwich of M-estimators: A^-1 B A^-1 with A the Hessian including
// rho'', B the sum of g g^T over features, g their gradients.  Both assume that features err
// independently; V and B are replaced as far as those of a pose do not (gradient_variance.hpp).
// Source: Huber, Robust Statistics, 1981, 6.3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/trust/noise/gradient_variance.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// The uncertainty of the free parameters of a step.
struct Uncertainty {
  int determined = 0;      ///< number of directions that samples and priors determine
  PlainMatrix covariance;  ///< (free x free), units of the parameters; zero along undetermined
                           ///< directions
  /// Standard deviation of each free parameter; infinite if samples and priors do not determine it.
  PlainMatrix deviation;
  /// Factor of the covariance as features of a pose err together, in the mean of all parameters: see
  /// gradient_variance().
  double design_effect = 1.0;
  bool by_links = false;  ///< features of a link err together, more than those of a pose
};

/// Covariance of the free parameters.
/// @param noise      of each error block: see estimate_noise()
/// @param poses      of the problem's samples
/// @param links      on which their features lie
/// @param of_priors  (coordinates x coordinates) variance of the gradients of priors
[[nodiscard]] Uncertainty uncertainty(const AnyProblem& problem, const LinearFit& fit,
                                      const std::vector<BlockNoise>& noise, const PoseGroups& poses,
                                      const FeatureLinks& links, const Eigen::MatrixXd& of_priors);

namespace detail {
/// Standard deviations from a covariance; infinite if more than a little of a parameter is
/// undetermined.
/// @param lost  (free) see Coordinates
[[nodiscard]] PlainMatrix deviations(const PlainMatrix& covariance, const PlainMatrix& lost);

/// Sets deviations to infinity where an undetermined combination could move the parameter by more
/// than its own deviation.  Assumes that the combination is off as far as typical robots are: 2
/// degrees, 8 mm or 2 % of its largest parameter.
/// @param free  the parameters of `known`
void mark_undetermined(const AnyProblem& problem, const FreeSet& free, const Coordinates& by,
                       Uncertainty& known);
}  // namespace detail

/// Two parameters that are nearly indistinguishable.
struct Correlation {
  int a = 0, b = 0;          ///< columns of the free set
  double coefficient = 0.0;  ///< -1 to 1
};

/// Pairs of parameters whose correlation is above a limit, the largest first.
[[nodiscard]] std::vector<Correlation> high_correlations(const Uncertainty& known,
                                                         double limit = 0.9);

}  // namespace kinecal
