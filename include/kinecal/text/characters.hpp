// Characters of UTF-8, and which of them people may see: for terminals, pages and charts.
//
// A control character can move a terminal's cursor, change colours or hide a message; one that changes the
// direction of writing can show a name, or what stands beside it, in another order than it is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// What stands for bytes that are not UTF-8.
inline constexpr char32_t kNoCharacter = 0xFFFD;

/// Marks around a text whose direction of writing must not affect its neighbours.
inline constexpr char32_t kIsolate = 0x2068, kEndOfIsolate = 0x2069;

/// True unless a character controls a device or the direction of writing, or ends a line.
[[nodiscard]] bool is_shown(char32_t c);

/// The character at a position; moves the position past it.  kNoCharacter, and one byte, if it is not UTF-8.
/// Source: RFC 3629.
[[nodiscard]] char32_t next_character(std::string_view text, std::size_t& at);

/// Appends a character in UTF-8.
void append_character(std::string& text, char32_t c);

/// The text on one line: line ends and tabs are spaces, what must not be shown is U+FFFD.
[[nodiscard]] std::string one_line(std::string_view text);

/// True for Hebrew, Arabic and their neighbours.
[[nodiscard]] bool is_right_to_left(char32_t c);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/text/characters.ipp"
#endif
