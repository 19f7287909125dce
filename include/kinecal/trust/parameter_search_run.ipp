// The steps of a search: definitions of parameter_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
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
  Gain gain{number};
  const std::vector<int>& own = candidate.columns;
  const auto q = static_cast<double>(own.size());
  Eigen::MatrixXd rest = squared_(own, own);
  Eigen::VectorXd slope = gradient_(own);
  Eigen::MatrixXd cross;
  if (!whole.columns.empty()) {
    cross = whole.inverse * squared_(whole.columns, own);
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
  for (int k = 0; k < static_cast<int>(candidates.size()); ++k) {
    if (std::find(chosen.begin(), chosen.end(), k) != chosen.end()) continue;
    if (candidates[static_cast<std::size_t>(k)].columns.empty())
      continue;  // no residual depends on it
    all.push_back(gain_of(whole, candidates[static_cast<std::size_t>(k)], k));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Gain& a, const Gain& b) { return a.squares > b.squares; });
  return all;
}

std::vector<SearchStep> ParameterSearch::run(const std::vector<int>& base,
                                             const std::vector<SearchCandidate>& candidates,
                                             std::vector<int>& chosen) const {
  constexpr double kChance = 0.01;   // of a superfluous parameter in a search
  constexpr double kSure = 1.0;      // standard errors
  constexpr double kAlike = 0.9;     // share of the fall that another one explains, too
  constexpr double kFar = 0.5;       // of the sum of squares: linearize again
  constexpr std::size_t kTried = 8;  // of the best, before the search ends
  std::vector<SearchStep> steps;
  std::set<std::set<int>> seen;  // so that it ends
  const auto candidate = [&](int k) -> const SearchCandidate& {
    return candidates[static_cast<std::size_t>(k)];
  };
  Whole whole = whole_fit(detail::columns_of(base, candidates, chosen));
  const double begin = whole.squares, tests = static_cast<double>(candidates.size());
  const auto helps = [&](const Gain& gain, double& sure) {
    const SearchCandidate& of = candidate(gain.candidate);
    if (tests * std::max(gain.chance, chance_by_poses(whole, of)) > kChance) return false;
    const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
    if (!with.determined || !is_plausible(with, base.size())) return false;
    return improves(with.columns, whole.columns, kSure, sure);
  };
  // Those that explain what one does, and nothing beside it.
  const auto like = [&](const std::vector<Gain>& all, const Gain& one) {
    const Whole with = whole_fit(detail::joined(whole.columns, candidate(one.candidate).columns));
    std::vector<Gain> alike;
    for (const Gain& gain : all) {
      if (gain.candidate == one.candidate || gain.squares < kAlike * one.squares) continue;
      const Gain left = gain_of(with, candidate(gain.candidate), gain.candidate);
      if (left.squares < (1.0 - kAlike) * gain.squares) alike.push_back(gain);
    }
    return alike;
  };
  for (;;) {
    if (!seen.insert(std::set<int>(chosen.begin(), chosen.end())).second) return steps;
    const std::vector<Gain> all = gains(whole, candidates, chosen);
    SearchStep step;
    bool found = false;
    for (std::size_t i = 0; i < std::min(kTried, all.size()) && !found; ++i) {
      found = helps(all[i], step.certainty);
      if (!found) continue;
      step.candidate = all[i].candidate;
      std::vector<Gain> alike = like(all, all[i]);
      const auto first =
          std::min_element(alike.begin(), alike.end(), [&](const Gain& a, const Gain& b) {
            return candidate(a.candidate).rank < candidate(b.candidate).rank;
          });
      double sure = 0.0;
      if (first != alike.end() &&
          candidate(first->candidate).rank < candidate(step.candidate).rank &&
          helps(*first, sure)) {
        step.certainty = sure;
        std::swap(step.candidate, first->candidate);
      }
      for (const Gain& other : alike) step.alike.push_back(other.candidate);
    }
    if (!found) return steps;
    chosen.push_back(step.candidate);
    whole = whole_fit(detail::columns_of(base, candidates, chosen));
    step.fit = fit_of(whole.columns);
    steps.push_back(step);
    // What the new one has made superfluous.
    for (const int k : std::vector<int>(chosen.begin(), chosen.end() - 1)) {
      const std::vector<int> without = detail::columns_of(base, candidates, chosen, k);
      const Whole held = whole_fit(without);
      const Gain back = gain_of(held, candidate(k), k);
      double sure = 0.0;
      if (tests * back.chance <= kChance && improves(whole.columns, without, 0.0, sure)) continue;
      chosen.erase(std::find(chosen.begin(), chosen.end(), k));
      whole = held;
      steps.push_back({k, false, fit_of(without), -sure, {}});
    }
    if (whole.squares < kFar * begin) return steps;
  }
}

}  // namespace kinecal
