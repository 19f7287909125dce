// Numbers and names as C++ writes them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace kinecal::detail {

/// The characters that C++ allows in a name: ASCII, whatever the locale.
[[nodiscard]] constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
[[nodiscard]] constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Numbers with commas between them, each the shortest that reads back as the same: -0.0 keeps its
/// sign, and none is an integer.
[[nodiscard]] inline std::string cpp_numbers(std::span<const double> numbers) {
  std::string all;
  for (double number : numbers) all += fmt::format("{}{:#}", all.empty() ? "" : ", ", number);
  return all;
}

/// A string literal.  Bytes beyond ASCII are escaped, too, and '?', which may begin a trigraph: no
/// compiler has to agree what they mean.
[[nodiscard]] inline std::string cpp_string(std::string_view text) {
  std::string literal = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '?') {
      literal += {'\\', c};
    } else if (c >= ' ' && c <= '~') {
      literal += c;
    } else {
      literal += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    }
  }
  return literal + '"';
}

/// True if a namespace may have this name: an identifier that neither C++ nor kinecal has taken.
[[nodiscard]] inline bool is_namespace_name(std::string_view name) {
  static constexpr std::string_view kTaken =
      " kinecal std alignas alignof and and_eq asm auto bitand bitor bool break case catch "
      "char char16_t char32_t char8_t class co_await co_return co_yield compl concept "
      "const const_cast consteval constexpr constinit continue decltype default delete do "
      "double dynamic_cast else enum explicit export extern false float for friend goto if "
      "inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq "
      "private protected public register reinterpret_cast requires return short signed "
      "sizeof static static_assert static_cast struct switch template this thread_local "
      "throw true try typedef typeid typename union unsigned using virtual void volatile "
      "wchar_t while xor xor_eq ";
  const auto may_follow = [](char c) { return is_letter(c) || is_digit(c) || c == '_'; };
  return !name.empty() && !is_digit(name.front()) && std::ranges::all_of(name, may_follow) &&
         kTaken.find(" " + std::string(name) + " ") == std::string_view::npos;
}

/// True for `a` and `a::b`.
[[nodiscard]] inline bool is_namespace(std::string_view name) {
  const std::size_t end = name.find("::");
  if (!is_namespace_name(name.substr(0, end))) return false;
  return end == std::string_view::npos || is_namespace(name.substr(end + 2));
}

/// The letters and digits of a name, all else between them one '_'.
[[nodiscard]] inline std::string joined_words(std::string_view name) {
  std::string joined;
  bool in_word = false;
  for (const char c : name) {
    const bool was_in_word = std::exchange(in_word, is_letter(c) || is_digit(c));
    if (!in_word) continue;
    if (!was_in_word && !joined.empty()) joined += '_';
    joined += c;
  }
  return joined;
}

}  // namespace kinecal::detail
