// The steps of a search: definitions of parameter_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/trust/parameter_search_gain.ipp"

namespace kinecal {

bool ParameterSearch::helps(const Whole& whole, const Gain& gain, const Candidates& candidates,
                            std::size_t base, const Evidence& evidence) const {
  if (!whole.determined) return false;
  const SearchCandidate& of = candidates[static_cast<std::size_t>(gain.candidate)];
  if (std::max(gain.chance, chance_by_poses(whole, of)) > evidence.chance) return false;
  const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
  return with.determined && is_plausible(with, base) &&
         certainty_of(with.columns, whole.columns) > evidence.sure;
}

bool ParameterSearch::free_one(const std::vector<int>& base, const Candidates& candidates,
                               std::vector<int>& chosen, const Evidence& of_all) const {
  constexpr std::size_t kTried = 8;  // of the best, before the search ends
  const auto tried = std::count_if(candidates.begin(), candidates.end(),
                                   [](const auto& of) { return !of.columns.empty(); });
  const Evidence evidence{of_all.chance / static_cast<double>(tried), of_all.sure};
  const Whole whole = whole_fit(detail::columns_of(base, candidates, chosen));
  const std::vector<Gain> all = gains(whole, candidates, chosen);
  for (std::size_t i = 0; i < std::min(kTried, all.size()); ++i) {
    if (!helps(whole, all[i], candidates, base.size(), evidence)) continue;
    chosen.push_back(all[i].candidate);
    return true;
  }
  return false;
}

void ParameterSearch::hold_superfluous(const std::vector<int>& base, const Candidates& candidates,
                                       std::vector<int>& chosen) const {
  const Evidence evidence{0.02, 0.5};  // beside the others: it has been found already
  for (;;) {                           // the least certain first
    int weakest = -1;
    double least = 0.0;
    for (const int k : chosen) {
      const Whole without = whole_fit(detail::columns_of(base, candidates, chosen, k));
      const Gain gain = gain_of(without, candidates[static_cast<std::size_t>(k)], k);
      if (helps(without, gain, candidates, base.size(), evidence)) continue;
      if (weakest >= 0 && gain.squares >= least) continue;
      weakest = k;
      least = gain.squares;
    }
    if (weakest < 0) return;
    chosen.erase(std::find(chosen.begin(), chosen.end(), weakest));
  }
}

std::vector<int> ParameterSearch::saturated(const std::vector<int>& base,
                                            const Candidates& candidates, std::vector<int> chosen,
                                            const std::vector<int>& ranks) const {
  for (const int r : ranks) {
    for (;;) {
      const Whole whole = whole_fit(detail::columns_of(base, candidates, chosen));
      const std::vector<Gain> all = gains(whole, candidates, chosen);
      const auto next = std::find_if(all.begin(), all.end(), [&](const Gain& gain) {
        const SearchCandidate& of = candidates[static_cast<std::size_t>(gain.candidate)];
        if (of.rank != r || gain.squares <= 0.0) return false;
        const Whole with = whole_fit(detail::joined(whole.columns, of.columns));
        return with.determined && is_plausible(with, base.size());
      });
      if (next == all.end()) break;
      chosen.push_back(next->candidate);
    }
  }
  return chosen;
}

int ParameterSearch::simplest(const std::vector<int>& base, const Candidates& candidates,
                              const std::vector<int>& chosen, int k) const {
  const auto rank = [&](int c) { return candidates[static_cast<std::size_t>(c)].rank; };
  const Whole without = whole_fit(detail::columns_of(base, candidates, chosen, k));
  for (const int other : like(without, candidates, chosen, k)) {
    if (rank(other) < rank(k)) k = other;
  }
  return k;
}

std::vector<int> ParameterSearch::like(const Whole& without, const Candidates& candidates,
                                       const std::vector<int>& chosen, int k) const {
  constexpr double kAlike = 0.9;    // share of the fall that another one explains, too
  constexpr double kAsWell = 1.04;  // squares of errors on held-out poses: 2 %
  const auto with = [&](int c) {
    return detail::joined(without.columns, candidates[static_cast<std::size_t>(c)].columns);
  };
  const Gain own = gain_of(without, candidates[static_cast<std::size_t>(k)], k);
  const Eigen::VectorXd of_own = predicted(with(k), folds_);
  const auto is_as_good = [&](const std::vector<int>& other) {
    const Eigen::VectorXd of_other = predicted(other, folds_);
    return (of_other.size() > 0 && of_other.sum() <= kAsWell * of_own.sum()) ||
           certainty(of_other, of_own) <= kSure || certainty_of(with(k), other) <= kSure;
  };
  std::vector<int> others;
  for (const Gain& gain : gains(without, candidates, chosen)) {
    if (gain.squares < kAlike * own.squares) break;
    // Where little noise is left, a tenth of the fall can be certain, and much.
    if (is_as_good(with(gain.candidate))) others.push_back(gain.candidate);
  }
  return others;
}

void ParameterSearch::run(const std::vector<int>& base, const Candidates& candidates,
                          std::vector<int>& chosen) const {
  constexpr double kFar = 0.5;               // of the sum of squares: linearize again
  constexpr Evidence kOfSearch{0.2, kSure};  // what is superfluous is held again
  const auto columns = [&](const std::vector<int>& of) {
    return detail::columns_of(base, candidates, of);
  };
  std::vector<int> determined;  // at this linearization
  for (const int k : chosen) {
    determined.push_back(k);
    if (!whole_fit(columns(determined)).determined) determined.pop_back();
  }
  chosen = determined;
  const double begin = whole_fit(columns(chosen)).squares;
  std::set<std::set<int>> seen;  // so that it ends
  int ranks = 0;
  for (const SearchCandidate& candidate : candidates) ranks = std::max(ranks, candidate.rank);
  if (chosen
          .empty()) {  // zeros and mounts together: what is far off makes anything look like a help
    // A mount has the zero of its joint in it, so it is first.
    const std::vector<int> zeros = saturated(base, candidates, chosen, {1, 0});
    const bool far = whole_fit(columns(zeros)).squares < kFar * begin;
    if (far && certainty_of(columns(zeros), columns(chosen)) > kSure) {
      for (const int k : zeros) {  // a mount alone, if it leaves nothing to the others
        if (candidates[static_cast<std::size_t>(k)].rank != 1) break;
        chosen.push_back(k);
        if (!(certainty_of(columns(zeros), columns(chosen)) > kSure)) return;
      }
      chosen = zeros;
      return;
    }
  }
  for (;;) {
    while (seen.insert(std::set<int>(chosen.begin(), chosen.end())).second &&
           free_one(base, candidates, chosen, kOfSearch)) {
      hold_superfluous(base, candidates, chosen);
      if (whole_fit(columns(chosen)).squares < kFar * begin) return;
    }
    // Many small errors at once, none of which shows alone: begin with all, and hold what is superfluous.
    std::vector<int> best = chosen;
    std::vector<int> up_to;
    for (int rank = 0; rank <= ranks; ++rank) {
      up_to.push_back(rank);
      std::vector<int> all = saturated(base, candidates, chosen, up_to);
      if (all.size() == chosen.size() || !(certainty_of(columns(all), columns(best)) > kSure))
        continue;
      hold_superfluous(base, candidates, all);
      if (certainty_of(columns(all), columns(best)) > kSure) best = std::move(all);
    }
    if (best == chosen) hold_superfluous(base, candidates, best);
    if (best == chosen || !seen.insert(std::set<int>(best.begin(), best.end())).second) break;
    chosen = std::move(best);
    if (whole_fit(columns(chosen)).squares < kFar * begin) return;
  }
  for (int& k : chosen) k = simplest(base, candidates, chosen, k);
}

}  // namespace kinecal
