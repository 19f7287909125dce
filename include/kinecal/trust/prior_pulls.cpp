// Finds priors that the samples contradict.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/prior_pulls.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/trust/weak_parameters.hpp"

namespace kinecal {

std::vector<PriorPull> prior_pulls(const AnyProblem& problem, const FreeSet& free,
                                   ParameterValues values, const LinearFit& fit,
                                   const Eigen::MatrixXd& inverse, const Uncertainty& known) {
  constexpr double kMost = 4.0;    // standard deviations
  constexpr double kOfUse = 0.01;  // of useful_deviation(): 0.05 degrees, 0.2 mm, 0.05 %
  std::vector<PriorPull> pulls;
  TermResiduals rows;
  for (const PriorTerm& prior : problem.priors()) {
    prior.evaluate(problem.table(), values, &free, rows);
    NormalEquations of_prior(free.size());
    of_prior.add_prior(prior, rows, problem.num_samples(), Losses::as_given);
    const Eigen::MatrixXd& basis = fit.coordinates.basis;
    const Eigen::VectorXd shift = basis * (inverse * (basis.transpose() * of_prior.gradient));
    PriorPull pull{.prior = prior.name};
    for (int c = 0; c < free.size(); ++c) {
      const int p = free.parameters()[static_cast<std::size_t>(c)];
      const double by = std::abs(shift(c)), times = by / known.deviation(c);
      if (!(by > kOfUse * useful_deviation(problem.table()[p])) || !(times > pull.times)) continue;
      pull.parameter = p;
      pull.shift = shift(c);
      pull.times = times;
    }
    if (pull.times > kMost) pulls.push_back(std::move(pull));
  }
  std::stable_sort(pulls.begin(), pulls.end(),
                   [](const PriorPull& a, const PriorPull& b) { return a.times > b.times; });
  return pulls;
}

}  // namespace kinecal
