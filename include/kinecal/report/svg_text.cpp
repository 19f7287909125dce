// Texts and numbers in charts.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/svg_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/text/characters.hpp"

namespace kinecal::detail {

/// The characters of a text on one line.
[[nodiscard]] inline std::vector<char32_t> characters_of(std::string_view text) {
  const std::string line = one_line(text);
  std::vector<char32_t> characters;
  for (std::size_t at = 0; at < line.size();) characters.push_back(next_character(line, at));
  return characters;
}

std::string svg_escaped(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size() + 8);
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = next_character(text, at);
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      case '\n':
      case '\r':
      case '\t':
        escaped += ' ';
        break;
      default:
        append_character(escaped,
                         is_shown(c) || c == kIsolate || c == kEndOfIsolate ? c : kNoCharacter);
    }
  }
  return escaped;
}

std::string shortened(std::string_view name, std::size_t most) {
  const std::size_t bytes = 4 * most;  // surely enough bytes for this many characters
  const bool is_long = name.size() > 2 * bytes + 16;
  std::vector<char32_t> all = characters_of(is_long ? name.substr(0, bytes) : name);
  if (is_long) {
    const std::vector<char32_t> end = characters_of(name.substr(name.size() - bytes));
    all.insert(all.end(), end.begin(), end.end());
  }
  const bool isolate = std::any_of(all.begin(), all.end(), is_right_to_left);
  if (all.size() > most && most > 2) {
    const std::size_t head = most / 2, tail = most - head - 1;
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(head),
              all.end() - static_cast<std::ptrdiff_t>(tail));
    all.insert(all.begin() + static_cast<std::ptrdiff_t>(head), U'…');
  }
  std::string text;
  if (isolate) append_character(text, kIsolate);
  for (const char32_t c : all) append_character(text, c);
  if (isolate) append_character(text, kEndOfIsolate);
  return text;
}

std::string slug_of(std::string_view name) {
  constexpr std::size_t kMost = 40;
  std::string slug;
  for (const char c : name) {
    const char small = 'A' <= c && c <= 'Z' ? static_cast<char>(c + 32) : c;
    const bool kept = ('a' <= small && small <= 'z') || ('0' <= small && small <= '9') ||
                      small == '_' || small == '-';
    if (kept) slug += small;
    if (!kept && !slug.empty() && slug.back() != '-') slug += '-';
    if (slug.size() == kMost) break;
  }
  while (!slug.empty() && slug.back() == '-') slug.pop_back();
  return slug;
}

double text_width(std::string_view text) {
  double width = 0.0;
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = next_character(text, at);
    const bool narrow =
        c < 0x80 &&
        std::string_view(" .,:;'|!iljtf()[]").find(static_cast<char>(c)) != std::string_view::npos;
    const bool wide = (c >= 0x1100 && c < 0x1200) || (c >= 0x2E80 && c < 0xD800) || c >= 0x1F000 ||
                      c == 'm' || c == 'w' || c == 'M' || c == 'W' || c == '%' || c == '@';
    width += c == kIsolate || c == kEndOfIsolate ? 0.0 : narrow ? 0.38 : wide ? 1.0 : 0.62;
  }
  return width;
}

void append_coordinate(std::string& text, double value) {
  constexpr double kMost = 1e6;
  const double finite = std::isfinite(value) ? std::clamp(value, -kMost, kMost) : 0.0;
  const long tenths = std::lround(10.0 * finite);
  if (tenths < 0) text += '-';
  const long size = std::abs(tenths);
  fmt::format_int digits(size / 10);
  text.append(digits.data(), digits.size());
  if (size % 10 != 0) {
    text += '.';
    text += static_cast<char>('0' + size % 10);
  }
}

std::string coordinate(double value) {
  std::string text;
  append_coordinate(text, value);
  return text;
}

std::string count_text(std::size_t number) {
  std::string text = fmt::format("{}", number);
  for (std::size_t i = text.size(); number >= 10000 && i > 3; i -= 3) {
    text.insert(i - 3, "\u2009");  // a thin space
  }
  return text;
}

std::string figure(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  const std::string sign = value < 0.0 ? "\u2212" : "";
  if (size >= 1e7 || size < 1e-4) {
    std::string text = fmt::format("{:.{}e}", size, digits - 1);
    const std::size_t e = text.find('e');
    std::string mantissa = text.substr(0, e);
    if (mantissa.find('.') != std::string::npos) {
      mantissa.erase(mantissa.find_last_not_of('0') + 1);
      if (mantissa.back() == '.') mantissa.pop_back();
    }
    return sign + mantissa + fmt::format("e{}", std::stoi(text.substr(e + 1)));
  }
  const int whole = static_cast<int>(std::floor(std::log10(size))) + 1;
  const int behind = std::max(0, digits - whole);
  std::string text = fmt::format("{:.{}f}", size, behind);
  if (behind == 0 && size >= 9999.5)
    return sign + count_text(static_cast<std::size_t>(std::llround(size)));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return sign + text;
}

}  // namespace kinecal::detail
