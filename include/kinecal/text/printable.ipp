// Definitions of printable.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kinecal/text/characters.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

/// Appends a number's last digits in base 16.
inline void append_hexadecimal(std::string& text, char32_t number, int digits) {
  for (int i = digits - 1; i >= 0; --i) text += "0123456789abcdef"[(number >> (4 * i)) & 15U];
}

/// True for one byte that is not UTF-8, read as kNoCharacter.
[[nodiscard]] inline bool is_no_text(char32_t c, std::size_t bytes) {
  return c == kNoCharacter && bytes == 1;
}

}  // namespace detail

KINECAL_INLINE bool has_control_characters(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = at;
    const char32_t c = detail::next_character(text, at);
    const bool control = c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x2028 || c == 0x2029;
    if (detail::is_no_text(c, at - begin) || (control && c != '\t')) return true;
  }
  return false;
}

KINECAL_INLINE std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = at;
    const char32_t c = detail::next_character(text, at);
    if (detail::is_no_text(c, at - begin) || (c < 0x20 && c != '\n' && c != '\t')) {
      shown += "\\x";
      detail::append_hexadecimal(shown, static_cast<unsigned char>(text[begin]), 2);
    } else if (c >= 0x20 && !detail::is_shown(c)) {
      shown += "\\u";
      detail::append_hexadecimal(shown, c, 4);
    } else {
      shown += text.substr(begin, at - begin);
    }
  }
  return shown;
}

}  // namespace kinecal
