// Tests held parameters.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/held_changes.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/trust/unexplained.ipp"

namespace kinecal {

namespace detail {
namespace {

/// All free parameters as coordinates.
[[nodiscard]] Coordinates plain_coordinates(int size) {
  return {Eigen::MatrixXd::Identity(size, size), Eigen::MatrixXd(size, 0),
          Eigen::VectorXd::Zero(size), Eigen::VectorXd::Ones(size)};
}

/// True if the free parameters would move farther than robots are wrong.
/// @param columns  those of the free parameters in `all`
[[nodiscard]] bool moves_too_far(const AnyProblem& problem, const FreeSet& all,
                                 const std::vector<int>& columns, const Eigen::VectorXd& moves) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const int p = all.parameters()[static_cast<std::size_t>(columns[i])];
    const double by = std::abs(moves(static_cast<Eigen::Index>(i)));
    if (plausible_change(problem, p).exceeded(by)) return true;
  }
  return false;
}

}  // namespace
}  // namespace detail

std::vector<HeldChange> held_changes(const AnyProblem& problem, const FreeSet& all,
                                     const std::vector<double>& values, const std::set<int>& free,
                                     const std::vector<std::vector<int>>& groups) {
  constexpr double kChance = 1e-6;
  std::vector<HeldChange> changes(groups.size());
  const auto evaluator = problem.evaluator(all, 1);
  const LinearFit fit = linear_fit(*evaluator, values, detail::plain_coordinates(all.size()));
  if (detail::is_exact(problem, fit)) return changes;
  std::vector<int> columns;
  for (const int p : free) {
    if (all.column(p) >= 0) columns.push_back(all.column(p));
  }
  const Eigen::MatrixXd whole = information(fit, fit.loss);
  const Eigen::MatrixXd inside = whole(columns, columns);
  const Eigen::MatrixXd inverse = detail::Spectrum(inside).pseudo_inverse();
  const Eigen::MatrixXd jacobian = fit.jacobian;
  const Eigen::MatrixXd of_free = jacobian(Eigen::all, columns);
  const double squares = fit.loss.dot(fit.residual.cwiseAbs2());
  const auto freedom = static_cast<double>(fit.residual.size() - std::ssize(columns));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<int> held;
    for (const int p : groups[g]) held.push_back(all.column(p));
    const auto q = static_cast<int>(held.size());
    if (freedom <= 2.0 * q) continue;
    const Eigen::MatrixXd x = jacobian(Eigen::all, held);
    const Eigen::MatrixXd weighted = fit.loss.asDiagonal() * x;
    const detail::AddedColumns added{weighted.transpose() * x, weighted.transpose() * of_free,
                                     weighted.transpose() * fit.residual};
    const detail::Fall fall = detail::fall_of(added, detail::unit_lengths(added), inverse);
    const double share = std::clamp(fall.squares / squares, 0.0, 1.0);
    const double tests = static_cast<double>(groups.size());
    if (tests * detail::chance_of_share(share, q, freedom) > kChance) continue;
    if (detail::moves_too_far(problem, all, columns, fall.others)) continue;
    changes[g] = {std::sqrt((1.0 - share) * freedom / (freedom - q)), fall.change.norm()};
  }
  return changes;
}

}  // namespace kinecal
