// Priors that the samples contradict.
//
// A prior adds w^2 n r^2 / 2 to the cost, for n samples.  Without its gradient g the solution would
// shift by H^-1 g.  A correct prior moves a parameter by about one standard deviation at most, like
// noise.  One that moves it by several, and whose residuals are larger than its weights allow, contradicts the
// samples.  Its variance is then as large as its residuals say (Birge): r^T r / (k - h) for k residuals of
// leverage h, in units of what the weights say.
// Source: Birge, The Calculation of Errors by the Method of Least Squares, 1932.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/uncertainty.hpp"

namespace kinecal {

/// A prior that moves the solution further than chance explains.
struct PriorPull {
  std::string prior;   ///< its name
  int parameter = -1;  ///< table index of the one it moves most, in standard deviations
  double shift = 0.0;  ///< to first order; unit of the parameter
  double times = 0.0;  ///< the same in standard deviations
};

/// Priors that move some parameter by more than 2 standard deviations, more than chance explains; the largest first.
/// @param free      the parameters of `inverse` and `known`
/// @param values    of all parameters of the table: the solution
/// @param inverse   (free x free) of the information of the fit, priors included
/// @param variance  of the weighted residuals of priors: prior_variance()
/// @param known     with priors as their weights say
[[nodiscard]] std::vector<PriorPull> prior_pulls(const AnyProblem& problem, const FreeSet& free,
                                                 ParameterValues values,
                                                 const Eigen::MatrixXd& inverse, double variance,
                                                 const Uncertainty& known);

/// Variance of the priors' gradients: as their weights say, or as their residuals if these are larger.
/// @returns  (free x free); like the arguments as prior_pulls() takes them
[[nodiscard]] Eigen::MatrixXd prior_scatter(const AnyProblem& problem, const FreeSet& free,
                                            ParameterValues values, const Eigen::MatrixXd& inverse,
                                            double variance);

}  // namespace kinecal
