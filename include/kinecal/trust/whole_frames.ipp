// Whole frames in place of several of their parameters: for identify.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kinecal/trust/identification.ipp"

namespace kinecal::detail {

/// The chosen candidates with a whole frame in place of those that have part of it, or that it leaves undetermined.
[[nodiscard]] inline std::vector<int> with_frame(const ParameterSearch& linear,
                                                 const Identification& search, int frame,
                                                 const std::vector<int>& chosen) {
  const auto columns = [&](int k) {
    return search.candidates()[static_cast<std::size_t>(k)].columns;
  };
  const std::vector<int> base = linear.independent(search.base()), of_frame = columns(frame);
  std::vector<int> with = {frame};
  for (const int k : chosen) {
    const std::vector<int> own = columns(k);
    if (std::find_first_of(own.begin(), own.end(), of_frame.begin(), of_frame.end()) != own.end())
      continue;
    with.push_back(k);
    if (!std::isfinite(linear.fit_of(base, search.candidates(), with).held_out)) with.pop_back();
  }
  return with;
}

/// Takes a whole frame in place of several parameters, where that frees no more and poses held out are predicted as
/// well: how a head or an arm is mounted is one cause, not five.  At a solution with it, as mounts are far off.
inline void take_whole_frames(Identification& search, Identified& found) {
  constexpr int kMount = 1;  // rank
  constexpr double kAsWell = 1.01;
  const auto all = static_cast<int>(search.candidates().size());
  for (int frame = 0; frame < all && found.chosen.size() > 1; ++frame) {
    const bool is_chosen =
        std::find(found.chosen.begin(), found.chosen.end(), frame) != found.chosen.end();
    const SearchCandidate& mount = search.candidates()[static_cast<std::size_t>(frame)];
    if (is_chosen || mount.rank != kMount || mount.columns.empty()) continue;
    const auto fit = [&](const ParameterSearch& linear, const std::vector<int>& chosen) {
      SearchFit of = linear.fit_of(linear.independent(search.base()), search.candidates(), chosen);
      of.held_out *= search.distance_of_one();
      return of;
    };
    const ParameterSearch now = search.linearized();
    const SearchFit before = fit(now, found.chosen);
    std::vector<int> with = with_frame(now, search, frame, found.chosen);
    CalibrationResult result = search.solve(with);
    if (result.converged) {
      const ParameterSearch linear = search.linearized();
      linear.run(linear.independent(search.base()), search.candidates(), with);
      result = search.solve(with);
    }
    if (result.converged && search.is_plausible(with) && with.size() < found.chosen.size()) {
      const SearchFit after = fit(search.linearized(), with);
      if (after.columns <= before.columns && after.held_out <= kAsWell * before.held_out) {
        found.chosen = std::move(with);
        found.result = std::move(result);
        continue;
      }
    }
    search.begin_at(found.result.table);
    found.result = search.solve(found.chosen);
  }
}

}  // namespace kinecal::detail
