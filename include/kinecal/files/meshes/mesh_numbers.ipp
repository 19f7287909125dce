// Parses numbers in the text of mesh files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

namespace kinecal::detail {

/// Parses and removes the next number of a text; nullopt if absent.
template <class T>
[[nodiscard]] std::optional<T> next_number(std::string_view& text) {
  const std::size_t at = text.find_first_not_of(" \t\r\n");
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(at);
  if (text.front() == '+') text.remove_prefix(1);
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

/// All numbers of a text, up to the first that is invalid.
template <class T>
[[nodiscard]] std::vector<T> all_numbers(std::string_view text) {
  std::vector<T> all;
  while (const auto number = next_number<T>(text)) all.push_back(*number);
  return all;
}

}  // namespace kinecal::detail
