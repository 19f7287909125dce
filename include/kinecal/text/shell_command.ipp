// Definitions of shell_command.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kinecal/text/characters.hpp"
#include "kinecal/text/name_list.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal {

namespace detail {

/// A word in quotes with escapes: each byte of a character that is not shown is \ooo, in base 8, and so are quotes.
/// Thus shells that do not know these escapes end the word in the same place.
[[nodiscard]] inline std::string escaped_shell_word(std::string_view word) {
  std::string quoted = "$'";
  for (std::size_t at = 0; at < word.size();) {
    const std::size_t begin = at;
    const char32_t c = next_character(word, at);
    const std::string_view bytes = word.substr(begin, at - begin);
    const bool is_text = is_shown(c) && (c != kNoCharacter || bytes.size() > 1);
    if (is_text && c != '\'' && c != '\\') {
      quoted += bytes;
    } else {
      for (const char byte : bytes) {
        const auto number = static_cast<unsigned char>(byte);
        quoted += '\\';
        for (int shift = 6; shift >= 0; shift -= 3) quoted += "01234567"[(number >> shift) & 7U];
      }
    }
  }
  return quoted + "'";
}

}  // namespace detail

KINECAL_INLINE std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./=:,+@%";
  const bool is_plain = word.find_first_not_of(kPlain) == std::string_view::npos;
  if (is_plain && !word.empty() && word.front() != '=') return std::string(word);  // zsh: =command
  if (detail::one_line(word) != word) return detail::escaped_shell_word(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

KINECAL_INLINE ShellCommand& ShellCommand::add_option(const std::string& option,
                                                      const std::vector<std::string>& values) {
  bool is_open = false;  // the option stands before the next value
  for (const std::string& value : values) {
    const bool looks_like_option = value.starts_with('-');
    if (!looks_like_option && !is_open) words_.push_back(option);
    words_.push_back(looks_like_option ? option + "=" + value : value);
    is_open = !looks_like_option;
  }
  return *this;
}

KINECAL_INLINE ShellCommand& ShellCommand::add_names(const std::string& option,
                                                     const std::vector<std::string>& names) {
  std::vector<std::string> entries;
  for (const std::string& name : names) entries.push_back(list_entry(name));
  return add_option(option, entries);
}

KINECAL_INLINE std::string ShellCommand::str() const {
  std::string line;
  for (const std::string& word : words_) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

}  // namespace kinecal
