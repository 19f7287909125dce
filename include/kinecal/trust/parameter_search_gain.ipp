// What candidates explain beside a subset: definitions of parameter_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/trust/parameter_search.hpp"

namespace kinecal {

namespace detail {

[[nodiscard]] inline std::vector<int> columns_of(const std::vector<int>& base,
                                                 const std::vector<SearchCandidate>& candidates,
                                                 const std::vector<int>& chosen, int except = -1) {
  std::vector<int> columns = base;
  for (const int k : chosen) {
    if (k != except)
      columns = joined(std::move(columns), candidates[static_cast<std::size_t>(k)].columns);
  }
  return columns;
}

}  // namespace detail

double ParameterSearch::chance_by_poses(const Whole& whole,
                                        const SearchCandidate& candidate) const {
  const std::vector<int>& own = candidate.columns;
  const auto q = static_cast<Eigen::Index>(own.size());
  Eigen::MatrixXd rest = jacobian_(Eigen::all, own);
  if (!whole.columns.empty()) {
    rest -= jacobian_(Eigen::all, whole.columns) * (whole.inverse * squared_(whole.columns, own));
  }
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(q, poses_);  // each pose's share of the slope
  for (Eigen::Index row = 0; row < rest.rows(); ++row) {
    slopes.col(pose_[static_cast<std::size_t>(row)]) +=
        rest.row(row).transpose() * whole.residual(row);
  }
  const Eigen::VectorXd slope = slopes.rowwise().sum();
  const Eigen::MatrixXd spread = slopes * slopes.transpose();
  const Eigen::MatrixXd inverse = detail::scaled_inverse(spread, spread.diagonal().cwiseSqrt());
  const double freedom = static_cast<double>(poses_ - q);
  if (inverse.size() == 0 || freedom < 1.0) return 1.0;
  const double statistic = slope.dot(inverse * slope);  // at most the number of poses
  const double share = std::min(statistic / poses_, 1.0 - 1e-12);
  return f_tail(share / (1.0 - share) * freedom / static_cast<double>(q), static_cast<double>(q),
                freedom);
}

ParameterSearch::Gain ParameterSearch::gain_of(const Whole& whole, const SearchCandidate& candidate,
                                               int number) const {
  if (!whole.determined) return {number};
  const Eigen::MatrixXd cross = whole.inverse * squared_(whole.columns, candidate.columns);
  return gain_of(whole, candidate, number, cross);
}

ParameterSearch::Gain ParameterSearch::gain_of(const Whole& whole, const SearchCandidate& candidate,
                                               int number, const Eigen::MatrixXd& cross) const {
  Gain gain{number};
  const std::vector<int>& own = candidate.columns;
  const auto q = static_cast<double>(own.size());
  Eigen::MatrixXd rest = squared_(own, own);
  Eigen::VectorXd slope = gradient_(own);
  if (!whole.columns.empty()) {
    rest -= squared_(own, whole.columns) * cross;
    slope -= cross.transpose() * gradient_(whole.columns);
  }
  if ((rest.diagonal().array() <= detail::kOwnShare * squared_.diagonal()(own).array()).any())
    return gain;
  const Eigen::MatrixXd inverse = detail::scaled_inverse(rest, scale_(own));
  if (inverse.size() == 0) return gain;
  gain.squares = slope.dot(inverse * slope);
  const double freedom = static_cast<double>(residual_.size() - std::ssize(whole.columns)) - q;
  if (freedom < 2.0 * q || poses_ < 2 * static_cast<int>(own.size())) return gain;
  const double left = std::max(whole.squares - gain.squares, std::numeric_limits<double>::min());
  gain.chance = f_tail(gain.squares / q / (left / freedom), q, freedom);
  return gain;
}

std::vector<ParameterSearch::Gain> ParameterSearch::gains(
    const Whole& whole, const std::vector<SearchCandidate>& candidates,
    const std::vector<int>& chosen) const {
  std::vector<Gain> all;
  if (!whole.determined) return all;
  const Eigen::MatrixXd cross = whole.inverse * squared_(whole.columns, Eigen::all);
  for (int k = 0; k < static_cast<int>(candidates.size()); ++k) {
    if (std::find(chosen.begin(), chosen.end(), k) != chosen.end()) continue;
    const std::vector<int>& own = candidates[static_cast<std::size_t>(k)].columns;
    const auto is_free = [&](int c) {
      return std::find(whole.columns.begin(), whole.columns.end(), c) != whole.columns.end();
    };
    if (own.empty() || std::any_of(own.begin(), own.end(), is_free)) continue;
    all.push_back(
        gain_of(whole, candidates[static_cast<std::size_t>(k)], k, cross(Eigen::all, own)));
  }
  constexpr double kSame = 1e-6;  // of the residuals: rounding decides nothing
  const auto order = [&](const Gain& gain) {
    return std::pair(-std::round(gain.squares / (kSame * whole.squares)),
                     candidates[static_cast<std::size_t>(gain.candidate)].rank);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Gain& a, const Gain& b) { return order(a) < order(b); });
  return all;
}

}  // namespace kinecal
