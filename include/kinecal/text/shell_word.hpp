// Words that a shell reads as they are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinecal {

/// A word as a POSIX shell reads it: in quotes if it has other than plain characters.
[[nodiscard]] inline std::string shell_word(std::string word) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./=:,+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  for (std::size_t at = 0; (at = word.find('\'', at)) != std::string::npos; at += 4) {
    word.replace(at, 1, "'\\''");
  }
  return "'" + word + "'";
}

}  // namespace kinecal
