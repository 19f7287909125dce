// Natural order of names: "view_2" before "view_10".
//
// Consecutive digits are one number, compared by value: leading zeros do not count.  Everything
// else is compared byte by byte.  Names that differ only in leading zeros are ordered by their
// bytes, so no two names are equal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string_view>

namespace kinecal {

namespace detail {

[[nodiscard]] constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Removes the number at the beginning of a text.
/// @returns  its digits without leading zeros
[[nodiscard]] constexpr std::string_view cut_number(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit) - text.begin();
  std::string_view digits = text.substr(0, static_cast<std::size_t>(end));
  text.remove_prefix(digits.size());
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

}  // namespace detail

/// True if one name comes before another.
[[nodiscard]] constexpr bool naturally_before(std::string_view a, std::string_view b) {
  std::string_view left = a, right = b;
  while (!left.empty() && !right.empty()) {
    if (detail::is_digit(left[0]) && detail::is_digit(right[0])) {
      const std::string_view x = detail::cut_number(left), y = detail::cut_number(right);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else if (left[0] != right[0]) {
      return left.substr(0, 1) < right.substr(0, 1);  // as bytes, whatever the sign of char
    } else {
      left.remove_prefix(1);
      right.remove_prefix(1);
    }
  }
  return left.size() != right.size() ? left.size() < right.size() : a < b;
}

/// True if one file name comes before another.  Extensions decide last, so "view.png" comes before
/// "view-1.png".
[[nodiscard]] constexpr bool file_naturally_before(std::string_view a, std::string_view b) {
  const std::string_view x = a.substr(0, a.rfind('.')), y = b.substr(0, b.rfind('.'));
  return x == y ? naturally_before(a, b) : naturally_before(x, y);
}

}  // namespace kinecal
