// Finds priors that the samples contradict.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/prior_pulls.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/weak_parameters.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A prior at the solution.
struct PriorSums {
  NormalEquations equations;
  double freedom = 0.0;  ///< k - h
  double times = 1.0;    ///< variance of its residuals over that of its weights
};

[[nodiscard]] PriorSums sums_of(const PriorTerm& prior, const AnyProblem& problem,
                                const FreeSet& free, ParameterValues values,
                                const Eigen::MatrixXd& inverse, double variance) {
  PriorSums sums{NormalEquations(free.size())};
  TermResiduals rows;
  prior.evaluate(problem.table(), values, &free, rows);
  sums.equations.add_prior(prior, rows, problem.num_samples(), Losses::as_given);
  const Eigen::MatrixXd& hessian = sums.equations.hessian;
  const auto rank = static_cast<double>(hessian.cols() - Spectrum(hessian).null);
  constexpr double kLeast = 0.05;  // of a residual: rounding
  sums.freedom = rank - inverse.cwiseProduct(hessian).sum();
  if (!(sums.freedom > kLeast) || !(variance > 0.0)) return sums;
  sums.times = 2.0 * sums.equations.cost / (variance * sums.freedom);
  return sums;
}

}  // namespace
}  // namespace detail

std::vector<PriorPull> prior_pulls(const AnyProblem& problem, const FreeSet& free,
                                   ParameterValues values, const Eigen::MatrixXd& inverse,
                                   double variance, const Uncertainty& known) {
  constexpr double kMost = 2.0, kChance = 0.01;
  constexpr double kOfUse = 0.01;   // of useful_deviation(): 0.05 degrees, 0.2 mm, 0.05 %
  constexpr double kMany = 1000.0;  // degrees of freedom of the noise
  std::vector<PriorPull> pulls;
  for (const PriorTerm& prior : problem.priors()) {
    const detail::PriorSums sums = detail::sums_of(prior, problem, free, values, inverse, variance);
    if (!(sums.times > 1.0) || f_tail(sums.times, sums.freedom, kMany) > kChance) continue;
    const Eigen::VectorXd shift = inverse * sums.equations.gradient;
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

Eigen::MatrixXd prior_scatter(const AnyProblem& problem, const FreeSet& free,
                              ParameterValues values, const Eigen::MatrixXd& inverse,
                              double variance) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(free.size(), free.size());
  for (const PriorTerm& prior : problem.priors()) {
    const detail::PriorSums sums = detail::sums_of(prior, problem, free, values, inverse, variance);
    all += variance * std::max(1.0, sums.times) * sums.equations.hessian;
  }
  return all;
}

}  // namespace kinecal
