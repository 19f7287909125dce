// Definitions of yaml_text.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/yaml/yaml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

namespace kinecal {

namespace detail {
namespace {

/// True for a word that every YAML reader takes for a string: letters, digits and _ / . - after a
/// letter, an underscore or a slash, except the words of YAML itself.
[[nodiscard]] bool is_plain_yaml_word(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto starts = [&](char c) { return is_letter(c) || c == '_' || c == '/'; };
  const auto continues = [&](char c) {
    return starts(c) || (c >= '0' && c <= '9') || c == '.' || c == '-';
  };
  if (word.empty() || !starts(word[0]) || !std::all_of(word.begin(), word.end(), continues)) {
    return false;
  }
  std::string lower(word);
  for (char& c : lower) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  constexpr std::array<std::string_view, 9> kReserved = {"null", "true", "false", "yes", "no",
                                                         "on",   "off",  "y",     "n"};
  return std::find(kReserved.begin(), kReserved.end(), lower) == kReserved.end();
}

/// The escape for the first character of a text (UTF-8) in double quotes, if needed: quotes and
/// backslashes, control characters, and characters that YAML takes for a line break or rejects.
/// @return  size of the character in bytes, and its escape; size 0 if not needed
[[nodiscard]] std::pair<std::size_t, std::string> yaml_escape(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (text[0] == '"' || text[0] == '\\') return {1, std::string("\\") + text[0]};
  if (byte(0) < 0x20 || byte(0) == 0x7f) return {1, fmt::format("\\x{:02x}", byte(0))};
  if (byte(0) == 0xc2 && text.size() > 1 && byte(1) < 0xa0) {  // U+0080 to U+009f
    return {2, fmt::format("\\x{:02x}", byte(1))};
  }
  if (text.starts_with("\xe2\x80\xa8")) return {3, "\\u2028"};
  if (text.starts_with("\xe2\x80\xa9")) return {3, "\\u2029"};
  if (text.starts_with("\xef\xbb\xbf")) return {3, "\\ufeff"};
  return {};
}

}  // namespace
}  // namespace detail

std::optional<double> number_from_yaml(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  if (text.starts_with('-') || text.starts_with('+')) return std::nullopt;
  if (text == ".inf" || text == ".Inf" || text == ".INF" || text == ".nan" || text == ".NaN" ||
      text == ".NAN") {
    text.remove_prefix(1);
  }
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return negative ? -value : value;
}

std::string number_to_yaml(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  std::string text = fmt::format("{}", value);
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

namespace detail {

std::string numbers_to_yaml(std::span<const double> numbers) {
  std::string text = "[";
  for (const double number : numbers) {
    if (text.size() > 1) text += ", ";
    text += number_to_yaml(number);
  }
  return text + "]";
}

std::string times_power_of_ten(std::string_view number, int by) {
  const std::size_t e = std::min(number.find_first_of("eE"), number.size());
  std::string_view digits = number.substr(std::min(e + 1, number.size()));
  if (digits.starts_with('+')) digits.remove_prefix(1);
  int exponent = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  return fmt::format("{}e{:+}", number.substr(0, e), exponent + by);
}

std::optional<double> metres_from_millimetres(std::string_view text) {
  const std::optional<double> millimetres = number_from_yaml(text);
  if (!millimetres || !std::isfinite(*millimetres)) return millimetres;
  return number_from_yaml(times_power_of_ten(text, -3));
}

std::string millimetres_from_metres(double metres) {
  std::string text = number_to_yaml(metres * 1e3);
  if (!std::isfinite(metres) || metres_from_millimetres(text) == metres) return text;
  return times_power_of_ten(number_to_yaml(metres), 3);
}

std::string name_to_yaml(std::string_view name) {
  if (name.empty()) return "''";
  if (is_plain_yaml_word(name)) return std::string(name);
  std::string quoted = "\"";
  while (!name.empty()) {
    const auto [size, escape] = yaml_escape(name);
    quoted += size > 0 ? escape : std::string(1, name[0]);
    name.remove_prefix(size > 0 ? size : 1);
  }
  return quoted + '"';
}

}  // namespace detail

}  // namespace kinecal
