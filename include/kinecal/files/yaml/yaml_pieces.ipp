// Splits a file of YAML documents into pieces that can be parsed independently, in any order.
//
// A line that begins with `---` in its first column, alone or before a blank, always begins a
// document: no scalar may contain it (YAML 1.2, 9.1.2).  Directives (%YAML, %TAG) stay with the
// document that follows them.  Each piece but the last ends with the `---` of the next one, so that
// an unclosed list gives the same error as in the whole file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <istream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace kinecal::detail {

/// Text that is not YAML, with the line of the error, from 1.
struct YamlError : std::runtime_error {
  YamlError(int error_line, const std::string& what) : std::runtime_error(what), line(error_line) {}
  int line;
};

struct YamlPiece {
  std::string text;
  int line = 1;  ///< of its first character, in the file
};

/// True if the `---` at `at` is a marker and not the start of a word.
[[nodiscard]] inline bool is_yaml_marker(std::string_view text, std::size_t at) {
  constexpr std::string_view kBlank = " \t\r\n";
  return at + 3 < text.size() && kBlank.find(text[at + 3]) != std::string_view::npos;
}

/// True if the last line before `at` is a directive, ignoring empty lines and comments.
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

/// Position of the last `---` after `from` that begins a document, or npos.
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

/// Cuts a text after its first line `...`, which ends a stream of documents.
/// @param rest  the text; keeps what follows the line
/// @return      what precedes the line, or the whole text
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
    if (!alone) continue;  // the start of a word, or an error
    const std::string_view part = rest.substr(0, marker);
    rest.remove_prefix(std::min(rest.find('\n', marker), rest.size() - 1) + 1);
    return part;
  }
  return std::exchange(rest, {});
}

class YamlPieces {
 public:
  /// Limits the piece of a file without `---`.
  static constexpr std::size_t kMostBytes = std::size_t{1} << 30;

  /// @param bytes  approximate size of a piece; a document is never cut
  /// @param most   largest size of a piece, bytes
  explicit YamlPieces(std::istream& in, std::size_t bytes, std::size_t most = kMostBytes)
      : in_(in), bytes_(std::max<std::size_t>(bytes, 1)), most_(most) {}

  /// The next piece; nothing at the end of the file.
  /// @throws YamlError  if a document is larger than the largest piece
  [[nodiscard]] std::optional<YamlPiece> next() {
    YamlPiece piece{std::exchange(rest_, {}), line_};
    std::string& text = piece.text;
    std::size_t cut = std::string::npos;
    while (cut == std::string::npos && in_) {
      if (text.size() > most_) {
        throw YamlError(line_, fmt::format("no '---' within {} bytes", text.size()));
      }
      // Possibly only part of a marker has been read; the one that begins this piece does not end
      // it.
      const std::size_t from = text.size() < 4 ? 0 : text.size() - 4;
      read(text);
      cut = last_yaml_start(text, from);
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
  std::string rest_;  ///< already read; belongs to the next piece
  int line_ = 1;      ///< of rest_
  char last_ = '\n';
};

}  // namespace kinecal::detail
