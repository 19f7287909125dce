// "Did you mean": the valid name nearest to a misspelt one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal {

namespace detail {

/// The last three rows of a table.  (Not a std::vector: with g++ 11 that is not a constant
/// expression.)
class ThreeRows {
 public:
  constexpr explicit ThreeRows(std::size_t columns)
      : columns_(columns), cells_(new std::size_t[3 * columns]{}) {}
  constexpr ~ThreeRows() { delete[] cells_; }
  ThreeRows(const ThreeRows&) = delete;
  ThreeRows& operator=(const ThreeRows&) = delete;

  /// Row i, from 0; it overwrites row i - 3.
  [[nodiscard]] constexpr std::size_t* operator[](std::size_t row) {
    return cells_ + row % 3 * columns_;
  }

 private:
  std::size_t columns_;
  std::size_t* cells_;
};

}  // namespace detail

/// Number of insertions, deletions, replacements and swaps of neighbours between two names; ignores
/// case.  Source: Damerau-Levenshtein distance, restricted.
[[nodiscard]] constexpr std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  const auto same = [&](char x, char y) { return x == y || lower(x) == lower(y); };
  detail::ThreeRows rows(b.size() + 1);  // a row for each letter of a
  for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t* const current = rows[i];
    const std::size_t* const previous = rows[i - 1];
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool swapped = i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]);
      const std::size_t replaced = previous[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      current[j] = std::min({replaced, previous[j] + 1, current[j - 1] + 1});
      if (swapped) current[j] = std::min(current[j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows[a.size()][b.size()];
}

/// The nearest of the candidates seen so far.
struct NearestName {
  std::string_view name = {};  ///< empty if no candidate is near enough
  std::size_t distance = 0;    ///< a nearer candidate must have a smaller edit distance

  /// The state before any candidate.  A misspelling differs in at most a third of its letters.
  [[nodiscard]] static constexpr NearestName none(std::string_view misspelt) {
    return {{}, misspelt.size() / 3 + 1};
  }
  /// The candidate if it is nearer than this one, else this one.
  [[nodiscard]] constexpr NearestName or_nearer(std::string_view candidate,
                                                std::string_view misspelt) const {
    const std::size_t n = misspelt.size(), m = candidate.size();
    if (std::max(n, m) - std::min(n, m) >= distance) return *this;  // at least as many insertions
    const std::size_t d = edit_distance(misspelt, candidate);
    return d < distance ? NearestName{candidate, d} : *this;
  }
};

/// The candidate nearest to `name`; nullopt if none is near enough.
template <class Names>
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view name, const Names& names) {
  NearestName nearest = NearestName::none(name);
  for (const std::string_view candidate : names) nearest = nearest.or_nearer(candidate, name);
  if (nearest.name.empty()) return std::nullopt;
  return std::string(nearest.name);
}

/// The end of an error message: "; did you mean 'x'?", or nothing if no candidate is near enough.
template <class Names>
[[nodiscard]] std::string did_you_mean(std::string_view name, const Names& names) {
  const auto nearest = nearest_name(name, names);
  return nearest ? "; did you mean '" + *nearest + "'?" : std::string();
}

}  // namespace kinecal
