// Normal equations as plain numbers, for code not compiled for the processor (plain_matrix.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// Cost, gradient and Gauss-Newton Hessian of a problem, priors included.
struct PlainEquations {
  double cost = 0.0;
  PlainMatrix gradient;  ///< (free)
  PlainMatrix hessian;   ///< (free x free)
};

/// @param values   of all parameters of the table
/// @param threads  number of threads; zero: one per core
[[nodiscard]] PlainEquations plain_equations(const AnyProblem& problem, const FreeSet& free,
                                             ParameterValues values, int threads = 1);

}  // namespace kinecal
