// Weak parameters: their standard deviation exceeds the typical errors of robots.
//
// Their values are large by chance and cancel in the given samples, but not elsewhere.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/uncertainty/uncertainty.hpp"

namespace kinecal {

/// Poorly determined parameters, and what to do about them.
struct WeakParameters {
  std::vector<int> parameters;  ///< table indices
  /// Parameters to hold so that no weak ones remain: frames before sensors, sensors before joints,
  /// and of these the one with the largest uncertainty.
  std::vector<int> hold;
};

/// The largest useful standard deviation of a parameter: 5 degrees, 20 mm, 5 % of a factor, 20 px;
/// infinite for other units.
[[nodiscard]] double useful_deviation(const Parameter& parameter);

/// The parameters that are determined, but with more than useful_deviation().
/// @param free    the parameters of `known`
/// @param beside  table indices that are judged otherwise: those of a lens by its pixels
[[nodiscard]] WeakParameters weak_parameters(const AnyProblem& problem, const FreeSet& free,
                                             const Uncertainty& known,
                                             const std::set<int>& beside = {});

}  // namespace kinecal
