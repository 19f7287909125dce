// Text as a template argument: Chain<fetch::Robot, "torso_lift_link", "wrist_roll_link">.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace kinecal {

template <std::size_t N>
struct FixedString {
  char text[N] = {};  ///< ends with a zero

  consteval FixedString(const char (&literal)[N]) {  // NOLINT: a literal is a text
    std::copy_n(literal, N, text);
  }
  [[nodiscard]] constexpr operator std::string_view() const {  // NOLINT
    return {static_cast<const char*>(text), N - 1};
  }
  [[nodiscard]] std::string string() const { return std::string(std::string_view(*this)); }
};

/// Texts are equal as texts, whatever their types.
template <std::size_t N, std::size_t M>
[[nodiscard]] constexpr bool operator==(const FixedString<N>& a, const FixedString<M>& b) {
  return std::string_view(a) == std::string_view(b);
}

/// A text as a constant that can be referred to.
template <FixedString Text>
inline constexpr std::string_view kView = Text;

/// A list of texts as a type.
template <FixedString... Texts>
struct Names {
  static constexpr std::array<std::string_view, sizeof...(Texts)> kAll = {Texts...};

  [[nodiscard]] static constexpr bool contains(std::string_view name) {
    return std::find(kAll.begin(), kAll.end(), name) != kAll.end();
  }
};

}  // namespace kinecal
