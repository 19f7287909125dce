// Counting measured numbers.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/measured_numbers.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal {

int measured_numbers(const AnyProblem& problem, ParameterValues values) {
  constexpr Eigen::Index kOfABody = 6;
  Eigen::Index numbers = 0;
  (void)evaluate(problem, values, nullptr, [&](int, int, const TermResiduals& rows) {
    const double used = rows.used.size() > 0 ? rows.used.sum() : 0.0;
    numbers +=
        std::min(rows.residual.size() - static_cast<Eigen::Index>(std::lround(used)), kOfABody);
  });
  return static_cast<int>(numbers);
}

}  // namespace kinecal
