// Definitions of solution_change.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/verify/solution_change.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The covariance of some parameters of a solution.
[[nodiscard]] Eigen::MatrixXd covariance_of(const CalibratedState& state,
                                            const std::vector<int>& parameters) {
  std::vector<Eigen::Index> columns;
  for (const int parameter : parameters) {
    columns.push_back(std::find(state.parameters.begin(), state.parameters.end(), parameter) -
                      state.parameters.begin());
  }
  return state.covariance.matrix()(columns, columns);
}

/// True if a solution says where a parameter is.
[[nodiscard]] bool determines(const CalibratedState& state, int parameter) {
  const auto column = std::find(state.parameters.begin(), state.parameters.end(), parameter) -
                      state.parameters.begin();
  if (column == std::ssize(state.parameters)) return false;
  const double variance = state.covariance(column, column);
  const auto is_part = [&](const Combination& combination) {
    return std::ranges::any_of(combination, [&](const auto& of) { return of.first == parameter; });
  };
  return variance > 0.0 && std::isfinite(variance) &&
         std::ranges::none_of(state.undetermined, is_part);
}

}  // namespace
}  // namespace detail

SolutionChange solution_change(const AnyProblem& problem, const CalibratedState& then,
                               const CalibratedState& now, double samples_freedom) {
  const auto compared = [&](const std::vector<int>& parameters) {
    OwnerChange change{.parameters = parameters};
    const Eigen::MatrixXd covariance =
        detail::covariance_of(then, parameters) + detail::covariance_of(now, parameters);
    Eigen::VectorXd d(std::ssize(parameters));
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      const auto p = static_cast<std::size_t>(parameters[static_cast<std::size_t>(i)]);
      d(i) = now.values[p] - then.values[p];
      change.change.push_back(d(i));
      change.deviation.push_back(std::sqrt(covariance(i, i)));
    }
    change.statistic = d.dot(detail::Spectrum(covariance).pseudo_inverse() * d);
    const auto freedom = static_cast<double>(d.size());
    change.probability =
        f_tail(change.statistic / freedom, freedom, std::max(1.0, samples_freedom));
    return change;
  };
  std::vector<int> all;
  for (const int parameter : then.parameters) {
    if (detail::determines(then, parameter) && detail::determines(now, parameter)) {
      all.push_back(parameter);
    }
  }
  SolutionChange change;
  if (all.empty()) return change;
  const OwnerChange of_all = compared(all);
  change.statistic = of_all.statistic;
  change.freedom = static_cast<int>(all.size());
  change.probability = of_all.probability;
  std::vector<int> rest = all;
  while (!rest.empty()) {
    const std::string& owner = problem.owners()[static_cast<std::size_t>(rest.front())];
    const auto others = std::stable_partition(rest.begin(), rest.end(), [&](int parameter) {
      return problem.owners()[static_cast<std::size_t>(parameter)] == owner;
    });
    change.owners.push_back(compared(std::vector<int>(rest.begin(), others)));
    change.owners.back().owner = owner;
    rest.erase(rest.begin(), others);
  }
  std::ranges::stable_sort(change.owners, {}, &OwnerChange::probability);
  return change;
}

}  // namespace kinecal
