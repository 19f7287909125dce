// Observability: which parameter combinations the samples cannot determine, because they change no
// residual.
//
// It is computed on the error-free problem (measurements replaced by the model's prediction),
// without priors.  J is its weighted Jacobian with columns scaled to length one.  A singular value
// of J below kUnobservable means that its parameter combination has no effect.  A basis of these
// combinations is reduced until each has a parameter with factor one that no other has.
// Source: Hollerbach, Wampler, The Calibration Index and Taxonomy for Robot Kinematic Calibration
// Methods, 1996; the error-free problem: ARCHITECTURE.md, "The error-free problem".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/solve/spectrum.hpp"

namespace kinecal {

/// A combination of parameters: table index and factor, the largest effect first.
using Combination = std::vector<std::pair<int, double>>;

/// What the samples of a step can determine.
struct Observability {
  int rank = 0;            ///< number of observable combinations
  double condition = 1.0;  ///< ratio of the largest to the smallest singular value of these
  std::vector<Combination> unobservable;  ///< combinations that change no residual
  /// Table indices of parameters to hold so that the others are observable: frames before sensors,
  /// sensors before joints, and of these the last before the first.
  std::vector<int> hold;
};

/// The observability of a problem's free parameters from its samples, near given values.
/// @param values  of all parameters of the table
[[nodiscard]] Observability observability(const AnyProblem& problem, const FreeSet& free,
                                          ParameterValues values);

namespace detail {

/// The same from the information of the samples.
[[nodiscard]] Observability observability_of(const AnyProblem& problem, const FreeSet& free,
                                             const SampleInformation& samples);

}  // namespace detail

}  // namespace kinecal
