// Definitions of plain_equations.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/plain_equations.hpp"

#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal {

PlainEquations plain_equations(const AnyProblem& problem, const FreeSet& free,
                               ParameterValues values, int threads) {
  const NormalEquations normal = problem.evaluator(free, threads)->normal_equations(values);
  return {normal.cost, PlainMatrix(normal.gradient), PlainMatrix(normal.hessian)};
}

}  // namespace kinecal
