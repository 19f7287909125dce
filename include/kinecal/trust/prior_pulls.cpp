// Finds priors that the samples contradict.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/prior_pulls.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A prior at the solution.
struct PriorMisfit {
  Eigen::MatrixXd hessian;   ///< (free x free)
  Eigen::VectorXd gradient;  ///< (free) J^T d
  double chance = 1.0;       ///< of residuals as large
  double bias = 0.0;         ///< share of d^T d that chance does not explain
};

[[nodiscard]] PriorMisfit misfit_of(const PriorTerm& prior, const AnyProblem& problem,
                                    const FreeSet& free, ParameterValues values,
                                    const Eigen::MatrixXd& inverse, double variance) {
  constexpr double kMany = 1000.0;  // degrees of freedom of the noise
  TermResiduals rows;
  prior.evaluate(problem.table(), values, &free, rows);
  const double squares = std::pow(prior.options.weight(), 2) * problem.num_samples();
  const double slope =
      prior.options.loss(squares / problem.num_samples() * rows.residual.squaredNorm()).derivative;
  const double weight = std::sqrt(squares * slope);
  std::vector<Eigen::Index> free_rows;
  for (Eigen::Index row = 0; row < rows.jacobian.rows(); ++row) {
    if (!rows.jacobian.row(row).isZero(0.0)) free_rows.push_back(row);
  }
  const Eigen::MatrixXd j = weight * rows.jacobian(free_rows, Eigen::all);
  const Eigen::VectorXd r = weight * rows.residual(free_rows);
  const Spectrum left(Eigen::MatrixXd::Identity(r.size(), r.size()) - j * inverse * j.transpose());
  const auto k = static_cast<double>(r.size() - left.null);
  PriorMisfit of{j.transpose() * j, Eigen::VectorXd::Zero(free.size())};
  if (k < 1.0 || !(variance > 0.0)) return of;
  const Eigen::MatrixXd back = left.pseudo_inverse();
  const Eigen::VectorXd d = back * r;
  of.gradient = j.transpose() * d;
  of.chance = f_tail(r.dot(d) / (variance * k), k, kMany);
  of.bias = std::max(0.0, 1.0 - variance * back.trace() / d.squaredNorm());
  return of;
}

}  // namespace
}  // namespace detail

std::vector<PriorPull> prior_pulls(const AnyProblem& problem, const FreeSet& free,
                                   ParameterValues values, const Eigen::MatrixXd& inverse,
                                   double variance, const Uncertainty& known) {
  constexpr double kMost = 2.0, kChance = 0.01;
  constexpr double kOfUse = 0.01;  // of useful_deviation(): 0.05 degrees, 0.2 mm, 0.05 %
  std::vector<PriorPull> pulls;
  for (const PriorTerm& prior : problem.priors()) {
    const detail::PriorMisfit of =
        detail::misfit_of(prior, problem, free, values, inverse, variance);
    if (of.chance > kChance) continue;
    const Eigen::VectorXd shift = inverse * of.gradient;
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
    const detail::PriorMisfit of =
        detail::misfit_of(prior, problem, free, values, inverse, variance);
    all += variance * of.hessian + of.bias * of.gradient * of.gradient.transpose();
  }
  return all;
}

}  // namespace kinecal
