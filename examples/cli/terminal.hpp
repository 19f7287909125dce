// Text for people: colored and as wide as the terminal; as it is in a file or a pipe.
//
// Every command prints with say() or show(): neither passes on a control character that a file or an
// argument holds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "kinecal/text/printable.hpp"

namespace kinecal::cli {

/// How a command speaks.
struct Manner {
  std::string color = "auto";  ///< "auto": on a terminal, without NO_COLOR; "always"; "never"
  bool quiet = false;          ///< only the last line
  bool verbose = false;        ///< also raw values, and what each step did
  bool json = false;           ///< the report as JSON, and nothing else
};

/// Prints as fmt::print() does, but printable().
template <class... T>
void say(std::FILE* out, fmt::format_string<T...> format, T&&... arguments) {
  fmt::print(out, "{}", printable(fmt::format(format, std::forward<T>(arguments)...)));
}
template <class... T>
void say(fmt::format_string<T...> format, T&&... arguments) {
  say(stdout, format, std::forward<T>(arguments)...);
}

/// A message whose further lines are indented, so that what it quotes from a file cannot begin a line.
/// What a hostile file makes endless is cut: a line to 2500 bytes, a message to 50 lines.
[[nodiscard]] std::string with_hanging_lines(std::string_view message);

/// True for a terminal that moves its cursor and changes colors: not with TERM=dumb, as in Emacs.
[[nodiscard]] bool obeys_escapes(int descriptor);

/// Columns of the terminal behind a file descriptor; 80 if that is not known.
[[nodiscard]] std::size_t terminal_width(int descriptor);

/// Prints text, for which lines are broken at the width of the terminal, with the verdict in its color.
void show(const std::string& text, const Manner& manner);

}  // namespace kinecal::cli
