// The columns of a search for wrong parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/trust/identify.hpp"

namespace kinecal::detail {

/// All columns that some residual depends on: first the base, then those of candidates.
[[nodiscard]] inline FreeSet all_columns(const AnyProblem& problem, const std::vector<int>& base,
                                         const std::vector<IdentifyCandidate>& candidates) {
  const std::vector<int> touched = problem.touched_parameters();
  std::vector<int> all;
  std::set<int> known;
  const auto add = [&](int p) {
    if (std::binary_search(touched.begin(), touched.end(), p) && known.insert(p).second)
      all.push_back(p);
  };
  for (const int p : base) add(p);
  for (const IdentifyCandidate& candidate : candidates) {
    for (const int p : candidate.parameters) add(p);
  }
  return FreeSet(std::move(all), problem.table().size());
}

}  // namespace kinecal::detail
