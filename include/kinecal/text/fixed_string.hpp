// Text as a template argument: Chain<fetch::Robot, "torso_lift_link", "wrist_roll_link">.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace kinecal {

/// A string literal as a template argument.
template <std::size_t N>
struct FixedString {
  char text[N] = {};  ///< ends with a zero

  /// Implicit, so that a literal works as a template argument.
  consteval FixedString(const char (&literal)[N]) {  // NOLINT: a literal is a text
    std::copy_n(literal, N, text);
  }
  /// The text without its final zero.
  [[nodiscard]] constexpr operator std::string_view() const {  // NOLINT
    return {static_cast<const char*>(text), N - 1};
  }
  /// A copy of the text.
  [[nodiscard]] std::string string() const { return std::string(std::string_view(*this)); }
};

/// Compares texts; their types may differ.
template <std::size_t N, std::size_t M>
[[nodiscard]] constexpr bool operator==(const FixedString<N>& a, const FixedString<M>& b) {
  return std::string_view(a) == std::string_view(b);
}

/// One text after the other.
template <std::size_t N, std::size_t M>
[[nodiscard]] consteval FixedString<N + M - 1> operator+(const FixedString<N>& a,
                                                         const FixedString<M>& b) {
  char both[N + M - 1] = {};
  std::copy_n(b.text, M, std::copy_n(a.text, N - 1, both));
  return both;
}

/// A text as a constant with an address.
template <FixedString Text>
inline constexpr std::string_view kView = Text;

/// A list of names as a type.
template <FixedString... Texts>
struct Names {
  /// The names, in order.
  static constexpr std::array<std::string_view, sizeof...(Texts)> kAll = {Texts...};

  /// True if the name is in the list.
  [[nodiscard]] static constexpr bool contains(std::string_view name) {
    return std::find(kAll.begin(), kAll.end(), name) != kAll.end();
  }
};

}  // namespace kinecal
