// Priors that the samples contradict.
//
// A prior adds n |w r|^2 / 2 to the cost, for n samples.  With r weighted, J its derivatives and
// L = J H^-1 J^T its leverage, the residuals at the solution of the samples alone are
//
//   d = (I - L)^-1 r      of variance (I - L)^-1, in that of the weighted residuals
//
// and the prior shifts the solution by H^-1 J^T d.  It contradicts the samples if r^T d is larger than
// chance explains, and it shifts a parameter by several standard deviations.  The covariance then includes
// this shift: its square, as far as d^T d exceeds tr (I - L)^-1.
// Source: Cook, Weisberg, Residuals and Influence in Regression, 1982.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/uncertainty/uncertainty.hpp"

namespace kinecal {

/// A prior that moves the solution further than chance explains.
struct PriorPull {
  std::string prior;   ///< its name
  int parameter = -1;  ///< table index of the one it moves most, in standard deviations
  double shift = 0.0;  ///< from the solution without it, to first order; unit of the parameter
  double times = 0.0;  ///< the same in standard deviations

  /// True if a result with it is to be used with care; below, +- include that prior and samples disagree.
  [[nodiscard]] bool contradicts() const { return times > 8.0; }
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

/// Mean square of the priors' gradients: of noise as their weights say, and of what contradicts the samples.
/// @returns  (free x free); like the arguments as prior_pulls() takes them
[[nodiscard]] Eigen::MatrixXd prior_scatter(const AnyProblem& problem, const FreeSet& free,
                                            ParameterValues values, const Eigen::MatrixXd& inverse,
                                            double variance);

}  // namespace kinecal
