// Lines of text that fit a width.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace kinecal {

/// Breaks lines at spaces so that they fit a width; what follows is indented two columns more than its line. Words
/// are not broken, nor rows of tables, which have three spaces in a row, nor commands of kinecal, which are to be pasted.
/// @param width  columns, of characters in UTF-8
[[nodiscard]] inline std::string wrapped(std::string_view text, std::size_t width) {
  const auto columns = [](std::string_view of) {
    return static_cast<std::size_t>(
        std::count_if(of.begin(), of.end(), [](char c) { return (c & 0xC0) != 0x80; }));
  };
  std::string all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    std::string_view words = line.substr(indent);
    all.append(indent, ' ');
    if (words.find("   ") != std::string_view::npos || words.starts_with("kinecal ")) {
      all.append(words);
      words = {};
    }
    std::size_t at = indent;
    for (bool first = true; !words.empty(); first = false) {
      const std::size_t space = std::min(words.find(' ', 1), words.size());
      const std::string_view word = words.substr(0, space);  // with the space before it
      words.remove_prefix(space);
      if (!first && at + columns(word) > width) {
        all.append("\n").append(indent + 2, ' ').append(word.substr(1));
        at = indent + 1 + columns(word);
      } else {
        all.append(word);
        at += columns(word);
      }
    }
    all += '\n';
  }
  return all;
}

}  // namespace kinecal
