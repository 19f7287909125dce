// "Did you mean": the valid name nearest to a misspelt one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal {

/// Number of insertions, deletions, replacements and swaps of neighbours between two names; letters
/// of different case count as equal.  Source: Damerau-Levenshtein, restricted.
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::size_t> two_back, previous(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = previous[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      current[j] = std::min({replaced, previous[j] + 1, current[j - 1] + 1});
      if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1])) {
        current[j] = std::min(current[j], two_back[j - 2] + 1);
      }
    }
    two_back = previous;
    std::swap(previous, current);
  }
  return previous[b.size()];
}

/// The candidate nearest to `name`, if it is near enough to be a misspelling: at most a third of
/// the name's letters differ.
template <class Names>
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view name, const Names& names) {
  std::optional<std::string> nearest;
  std::size_t least = name.size() / 3 + 1;
  for (const auto& candidate : names) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

/// "; did you mean 'x'?" for the nearest candidate, or nothing.
template <class Names>
[[nodiscard]] std::string did_you_mean(std::string_view name, const Names& names) {
  const auto nearest = nearest_name(name, names);
  return nearest ? "; did you mean '" + *nearest + "'?" : std::string();
}

}  // namespace kinecal
