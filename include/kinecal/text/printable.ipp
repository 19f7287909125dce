// Definitions of printable.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kinecal/linkage.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

/// Number of bytes of a character, from its first byte; 0 if that is invalid.
/// Source: RFC 3629.
[[nodiscard]] inline std::size_t utf8_length(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xc2) return 0;
  if (first < 0xe0) return 2;
  if (first < 0xf0) return 3;
  return first < 0xf5 ? 4 : 0;
}

/// Number of bytes of a text's first character; 0 if it is a control character (C0, DEL, C1) or not
/// UTF-8.
[[nodiscard]] inline std::size_t printable_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = utf8_length(byte(0));
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  const bool is_c0 = byte(0) < 0x20 || byte(0) == 0x7f;
  const bool is_c1 = byte(0) == 0xc2 && byte(1) < 0xa0;
  return is_c0 || is_c1 ? 0 : length;
}

}  // namespace detail

KINECAL_INLINE bool has_control_characters(std::string_view text) {
  return printable(text) != text;
}

KINECAL_INLINE std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const char first = text.front();
    const std::size_t length = first == '\n' || first == '\t' ? 1 : detail::printable_bytes(text);
    if (length == 0) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(first);
      shown += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 15U]};
      text.remove_prefix(1);
    } else {
      shown += text.substr(0, length);
      text.remove_prefix(length);
    }
  }
  return shown;
}

}  // namespace kinecal
