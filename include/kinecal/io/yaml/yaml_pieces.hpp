// Cuts a file of YAML documents into pieces that can be read on their own, in any order.
//
// A line that begins with `---` in its first column, alone or before a blank, begins a document
// wherever it stands: no scalar may hold it (YAML 1.2, 9.1.2).  Directives (%YAML, %TAG) belong to
// the document that follows them and are not cut off from it.  Each piece but the last ends with
// the `---` of the next one, so that what is left open is told as in the whole file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "kinecal/io/yaml/yaml_error.hpp"

namespace kinecal {

struct YamlPiece {
  std::string text;
  int line = 1;  ///< of its first character, in the file
};

namespace detail {

/// True if the `---` at `at` is a marker and not the start of a word.
[[nodiscard]] inline bool is_yaml_marker(std::string_view text, std::size_t at) {
  constexpr std::string_view kBlank = " \t\r\n";
  return at + 3 < text.size() && kBlank.find(text[at + 3]) != std::string_view::npos;
}

/// True if the last line before `at` that is not empty and no comment is a directive.
[[nodiscard]] inline bool follows_directive(std::string_view text, std::size_t at) {
  while (at > 0) {
    const std::size_t before = text.substr(0, at - 1).rfind('\n');
    const std::size_t line = before == std::string_view::npos ? 0 : before + 1;
    if (text[line] == '%') return true;
    const std::size_t word = text.find_first_not_of(" \t\r\n", line);
    if (word < at && text[word] != '#') return false;
    at = line;
  }
  return false;
}

/// Where the last `---` after `from` stands that begins a document; npos if there is none.
[[nodiscard]] inline std::size_t last_yaml_start(std::string_view text, std::size_t from) {
  const std::string_view searched = text.substr(from);
  std::size_t at = searched.size();
  while ((at = searched.rfind("\n---", at)) != std::string_view::npos) {
    const std::size_t marker = from + at + 1;
    if (is_yaml_marker(text, marker) && !follows_directive(text, marker)) return marker;
    if (at-- == 0) break;
  }
  return std::string_view::npos;
}

}  // namespace detail

/// Takes from a text what stands before its first line `...`, and this line: there everything ends,
/// and another stream of documents may follow.
/// @param rest  loses both
/// @return      what stands before the line, or all of the text
[[nodiscard]] inline std::string_view take_yaml_part(std::string_view& rest) {
  const auto next = [&](std::size_t from) {
    const std::size_t at = rest.find("\n...", from);
    return at == std::string_view::npos ? at : at + 1;
  };
  std::size_t marker = rest.starts_with("...") ? 0 : next(0);
  for (; marker != std::string_view::npos; marker = next(marker)) {
    const std::size_t after = rest.find_first_not_of(" \t\r", marker + 3);
    const bool alone = after == std::string_view::npos || rest[after] == '\n' ||
                       (rest[after] == '#' && after > marker + 3);
    if (!alone) continue;  // the start of a word, or a mistake
    const std::string_view part = rest.substr(0, marker);
    rest.remove_prefix(std::min(rest.find('\n', marker), rest.size() - 1) + 1);
    return part;
  }
  return std::exchange(rest, {});
}

class YamlPieces {
 public:
  /// A file without any `---` would be one piece of any size.
  static constexpr std::size_t kMostBytes = std::size_t{1} << 30;

  /// @param bytes  of a piece, about; a document is never cut
  /// @param most   bytes of a piece at most
  explicit YamlPieces(std::istream& in, std::size_t bytes, std::size_t most = kMostBytes)
      : in_(in), bytes_(std::max<std::size_t>(bytes, 1)), most_(most) {}

  /// The next piece; nothing at the end of the file.
  /// @throws YamlError  if a document is longer than the most bytes
  [[nodiscard]] std::optional<YamlPiece> next() {
    YamlPiece piece{std::exchange(rest_, {}), line_};
    std::string& text = piece.text;
    std::size_t cut = std::string::npos;
    while (cut == std::string::npos && in_) {
      if (text.size() > most_) {
        throw YamlError(line_, fmt::format("no '---' within {} bytes", text.size()));
      }
      // A marker may have been read in part; the one that begins this piece does not end it.
      const std::size_t from = text.size() < 4 ? 0 : text.size() - 4;
      read(text);
      cut = detail::last_yaml_start(text, from);
    }
    if (text.empty()) return std::nullopt;
    last_ = text.back();
    if (cut == std::string::npos) return piece;
    rest_ = text.substr(cut);
    text.resize(cut);
    line_ += static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    text += "---\n";
    return piece;
  }

  /// The last character of the last piece.
  [[nodiscard]] char last() const { return last_; }

 private:
  void read(std::string& text) {
    const std::size_t size = text.size();
    text.resize(size + bytes_);
    in_.read(text.data() + size, static_cast<std::streamsize>(bytes_));
    text.resize(size + static_cast<std::size_t>(in_.gcount()));
  }

  std::istream& in_;
  std::size_t bytes_, most_;
  std::string rest_;  ///< read, but of the next piece
  int line_ = 1;      ///< of rest_
  char last_ = '\n';
};

}  // namespace kinecal
