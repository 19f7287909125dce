// What the steps of a search buy: definitions of parameter_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "kinecal/trust/parameter_search_gain.ipp"

namespace kinecal {

SearchFit ParameterSearch::fit_of(const std::vector<int>& base, const Candidates& candidates,
                                  const std::vector<int>& chosen) const {
  const std::vector<int> columns = detail::columns_of(base, candidates, chosen);
  const auto root = [&](const Eigen::VectorXd& squares) {
    return squares.size() > 0 ? std::sqrt(squares.sum() / weight_)
                              : std::numeric_limits<double>::infinity();
  };
  SearchFit fit;
  fit.fitted = std::sqrt(whole_fit(columns).squares / weight_);
  const Eigen::VectorXd squares = predicted(columns, folds_);
  fit.held_out = root(squares);
  fit.region = regions_.empty() ? 0.0 : root(predicted(columns, regions_));
  fit.columns = static_cast<int>(columns.size());
  const auto n = static_cast<double>(squares.size());
  if (n > 1.0 && fit.held_out > 0.0) {  // d sqrt(s / w) = ds / (2 w sqrt(s / w))
    const double sum = std::sqrt(n / (n - 1.0) * (squares.array() - squares.mean()).square().sum());
    fit.deviation = sum / (2.0 * weight_ * fit.held_out);
  }
  return fit;
}

std::vector<SearchStep> ParameterSearch::path(const std::vector<int>& base,
                                              const Candidates& candidates,
                                              const std::vector<int>& chosen) const {
  std::vector<SearchStep> steps;
  std::vector<int> free, left = chosen;
  const Whole all = whole_fit(detail::columns_of(base, candidates, chosen));
  while (!left.empty()) {
    const Whole whole = whole_fit(detail::columns_of(base, candidates, free));
    const auto gain = [&](int k) {
      return gain_of(whole, candidates[static_cast<std::size_t>(k)], k).squares;
    };
    const auto next =
        std::max_element(left.begin(), left.end(), [&](int a, int b) { return gain(a) < gain(b); });
    SearchStep step{.candidate = *next};
    left.erase(next);
    free.push_back(step.candidate);
    const std::vector<int> without = detail::columns_of(base, candidates, chosen, step.candidate);
    step.fit = fit_of(base, candidates, free);
    step.certainty = certainty_of(detail::columns_of(base, candidates, chosen), without);
    step.alike = like(whole_fit(without), candidates, chosen, step.candidate);
    std::copy_if(step.alike.begin(), step.alike.end(), std::back_inserter(step.inseparable),
                 [&](int k) {
                   return gain_of(all, candidates[static_cast<std::size_t>(k)], k).squares <= 0.0;
                 });
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<SearchStep> ParameterSearch::beyond(const std::vector<int>& base,
                                                const Candidates& candidates,
                                                const std::vector<int>& chosen, int most) const {
  std::vector<SearchStep> steps;
  std::vector<int> free = chosen;
  while (static_cast<int>(steps.size()) < most) {
    const Whole whole = whole_fit(detail::columns_of(base, candidates, free));
    const std::vector<Gain> all = gains(whole, candidates, free);
    const auto next = std::find_if(all.begin(), all.end(), [&](const Gain& gain) {
      const SearchCandidate& of = candidates[static_cast<std::size_t>(gain.candidate)];
      const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
      return gain.squares > 0.0 && with.determined && is_plausible(with, base.size());
    });
    if (next == all.end()) break;
    SearchStep step{.candidate = next->candidate};
    const Whole with = whole_fit(detail::joined(
        whole.columns, candidates[static_cast<std::size_t>(step.candidate)].columns));
    free.push_back(step.candidate);
    step.fit = fit_of(base, candidates, free);
    step.certainty = certainty_of(with.columns, whole.columns);
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace kinecal
