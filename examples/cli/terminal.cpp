// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "kinecal/text/wrapped.hpp"

namespace kinecal::cli {
namespace {

constexpr std::string_view kPlain = "\033[0m";

/// Begin of a line that is emphasized, and how: bold, with the verdict's color.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kStyles = {{
    {"verdict: good", "\033[1;32m"},
    {"verdict: use with care", "\033[1;33m"},
    {"verdict: do not use", "\033[1;31m"},
    {"verdict: holds", "\033[1;32m"},
    {"verdict: does not hold", "\033[1;31m"},
    {"good ", "\033[1;32m"},
    {"use with care ", "\033[1;33m"},
    {"do not use ", "\033[1;31m"},
    {"Next:", "\033[1m"},
}};

bool is_colored(const Manner& manner) {
  if (manner.color != "auto") return manner.color == "always";
  const char* const off = std::getenv("NO_COLOR");
  return obeys_escapes(STDOUT_FILENO) && (off == nullptr || *off == '\0');
}

std::string colored(std::string_view text) {
  std::string all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    const auto style = std::find_if(kStyles.begin(), kStyles.end(),
                                    [&](const auto& of) { return line.starts_with(of.first); });
    if (style == kStyles.end()) {
      all += line;
    } else {
      all.append(style->second).append(style->first).append(kPlain);
      all += line.substr(style->first.size());
    }
  }
  return all;
}

}  // namespace

std::string with_hanging_lines(std::string_view message) {
  constexpr std::size_t kMostLines = 50, kLongest = 3000, kFirst = 2000, kLast = 500;
  std::string shown;
  std::size_t at = 0;
  for (std::size_t lines = 0; at <= message.size() && lines < kMostLines; ++lines) {
    const std::size_t end = std::min(message.find('\n', at), message.size());
    const std::string_view line = message.substr(at, end - at);
    if (at > 0) shown += "\n  ";
    if (line.size() > kLongest) {
      shown.append(line.substr(0, kFirst)).append(" ... ");
      shown.append(line.substr(line.size() - kLast));
    } else {
      shown += line;
    }
    at = end + 1;
  }
  if (at >= message.size()) return shown;
  const auto others =
      1 + std::count(message.begin() + static_cast<std::ptrdiff_t>(at), message.end(), '\n');
  return shown + fmt::format("\n  and {} more lines", others);
}

bool obeys_escapes(int descriptor) {
  const char* const kind = std::getenv("TERM");
  const bool is_dumb = kind == nullptr || std::string_view(kind) == "dumb";
  return isatty(descriptor) != 0 && !is_dumb;
}

std::size_t terminal_width(int descriptor) {
  winsize size{};
  const bool known = ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
  return known ? size.ws_col : 80;
}

void show(const std::string& text, const Manner& manner) {
  std::string shown = printable(text);
  if (isatty(STDOUT_FILENO) != 0) shown = wrapped(shown, terminal_width(STDOUT_FILENO));
  fmt::print("{}", is_colored(manner) ? colored(shown) : shown);
  std::fflush(stdout);
}

}  // namespace kinecal::cli
