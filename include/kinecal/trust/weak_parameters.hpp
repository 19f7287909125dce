// Parameters that samples hardly determine: their standard deviation exceeds the errors that robots
// have.
//
// Such values are large by chance and cancel in the samples at hand; elsewhere they do not.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/uncertainty.hpp"

namespace kinecal {

/// What samples hardly determine, and what to do.
struct WeakParameters {
  std::vector<int> parameters;  ///< table indices
  /// Of these, what to hold, so that none is left: frames rather than sensors, sensors rather than
  /// joints, and of these the one that is known worst.
  std::vector<int> hold;
};

/// The standard deviation up to which a parameter is of use: 5 degrees, 20 mm, 5 % of a factor,
/// 20 px; infinite for other units.
[[nodiscard]] double useful_deviation(const Parameter& parameter);

/// The parameters that are determined, but worse than useful_deviation().
/// @param free   the parameters of `known`
[[nodiscard]] WeakParameters weak_parameters(const AnyProblem& problem, const FreeSet& free,
                                             const Uncertainty& known);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/trust/weak_parameters.ipp"
#endif
