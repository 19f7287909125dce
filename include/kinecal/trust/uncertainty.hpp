// The covariance of the parameters at the solution, from the noise that the residuals show.
//
//   C = H^-1 V H^-1      H = sum w^2 J^T J + P      V = sum s_b^2 w^2 J^T J + s^2 P
//
// with P the priors, s_b the weighted noise of error block b, and s = 1 if all blocks have a sigma, else
// that of all blocks: without sigmas weights are ratios.  One common s gives s^2 H^-1.  With robust losses the
// sandwich of M-estimators: A^-1 B A^-1 with A the Hessian including rho'', B the sum of g g^T over
// features, g their gradients.  Both suppose that features err independently; where those of a sample do
// not, C is multiplied by the design effect.
// Source: Huber, Robust Statistics, 1981, 6.3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/trust/noise.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// How well the free parameters of a step are known.
struct Uncertainty {
  int determined = 0;      ///< number of directions that samples and priors determine
  PlainMatrix covariance;  ///< (free x free), units of the parameters; zero along directions
                           ///< that nothing determines
  /// Standard deviation of each free parameter; infinite if samples and priors do not determine it.
  PlainMatrix deviation;
  /// Factor in the covariance for features of a sample that err together: see design_effect().
  double design_effect = 1.0;
};

/// Covariance of the free parameters.
/// @param noise  of each error block: see estimate_noise()
[[nodiscard]] Uncertainty uncertainty(const AnyProblem& problem, const LinearFit& fit,
                                      const std::vector<BlockNoise>& noise);

namespace detail {
/// Standard deviations from a covariance; infinite where more than a little of a parameter is not
/// determined.
/// @param lost  (free) see Coordinates
[[nodiscard]] PlainMatrix deviations(const PlainMatrix& covariance, const PlainMatrix& lost);

/// Makes the deviation of parameters infinite that a small part in an undetermined combination can move
/// further than their own deviation, if that combination is off as far as robots are: by 2 degrees,
/// 8 mm or 2 % of its largest parameter.
/// @param free  the parameters of `known`
void mark_undetermined(const AnyProblem& problem, const FreeSet& free, const Coordinates& by,
                       Uncertainty& known);
}  // namespace detail

/// Two parameters that can hardly be told apart.
struct Correlation {
  int a = 0, b = 0;          ///< columns of the free set
  double coefficient = 0.0;  ///< -1 to 1
};

/// Pairs of parameters whose correlation is above a limit, the largest first.
[[nodiscard]] std::vector<Correlation> high_correlations(const Uncertainty& known,
                                                         double limit = 0.9);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/trust/uncertainty.ipp"
#endif
