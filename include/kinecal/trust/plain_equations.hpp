// Normal equations as plain numbers, for code not compiled for the processor (plain_matrix.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// Gradient and Gauss-Newton Hessian of a problem, priors included.
struct PlainEquations {
  PlainMatrix gradient;  ///< (free)
  PlainMatrix hessian;   ///< (free x free)
};

/// @param values  of all parameters of the table
[[nodiscard]] PlainEquations plain_equations(const AnyProblem& problem, const FreeSet& free,
                                             ParameterValues values);

}  // namespace kinecal
