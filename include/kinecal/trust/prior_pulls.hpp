// Priors that the samples contradict.
//
// A prior adds w^2 n r^2 / 2 to the cost, for n samples.  Without its gradient g the solution would
// shift by H^-1 g.  A correct prior moves a parameter by about one standard deviation at most, like
// noise.  One that moves it by several contradicts the samples, and the standard deviations, which
// treat it as a measurement, do not include the distortion.
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

/// Priors that move some parameter by more than 4 standard deviations, the largest first.
/// @param free     the parameters of `fit` and `known`
/// @param values   of all parameters of the table: the solution
/// @param inverse  (coordinates x coordinates) of the information of `fit`, priors included
[[nodiscard]] std::vector<PriorPull> prior_pulls(const AnyProblem& problem, const FreeSet& free,
                                                 ParameterValues values, const LinearFit& fit,
                                                 const Eigen::MatrixXd& inverse,
                                                 const Uncertainty& known);

}  // namespace kinecal
