// Definitions of json_text.hpp, by nlohmann-json.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/json/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>

namespace kinecal::detail {

/// @param depth  how many lists and objects it is in
inline void add_json_lines(const Json& json, std::size_t depth, std::string& text) {
  if (json.is_number_float() && std::isfinite(json.get<double>())) {
    fmt::format_to(std::back_inserter(text), "{}", json.get<double>());  // 1, not 1.0
    return;
  }
  if (!json.is_structured() || json.empty()) {
    text += json_text(json);
    return;
  }
  constexpr std::size_t kOwnLines = 2, kIndent = 2;
  const bool lines =
      depth < kOwnLines ||
      std::any_of(json.begin(), json.end(), [](const Json& item) { return item.is_structured(); });
  text += json.is_object() ? '{' : '[';
  for (auto item = json.begin(); item != json.end(); ++item) {
    if (item != json.begin()) text += lines ? "," : ", ";
    if (lines) text.append("\n").append(kIndent * (depth + 1), ' ');
    if (json.is_object()) text += json_text(item.key()) + ": ";
    add_json_lines(*item, depth + 1, text);
  }
  if (lines) text.append("\n").append(kIndent * depth, ' ');
  text += json.is_object() ? '}' : ']';
}

std::string json_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string json_in_html(const Json& json) {
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string html;
  html.reserve(text.size());
  for (const char c : text) {
    if (c == '<' || c == '>' || c == '&') {  // in strings only
      fmt::format_to(std::back_inserter(html), "\\u{:04x}", static_cast<int>(c));
    } else {
      html += c;
    }
  }
  return html;
}

std::string json_lines(const Json& json) {
  std::string text;
  add_json_lines(json, 0, text);
  return text + "\n";
}

Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return 0;
  double scale = 1.0;
  for (int i = 0; i < digits; ++i) scale *= 10.0;
  const double number = std::round(value * scale) / scale;
  constexpr double kWhole = 1e15;
  if (std::abs(number) < kWhole && number == std::floor(number)) {
    return static_cast<std::int64_t>(number);  // 1 is shorter than 1.0
  }
  return number;
}

}  // namespace kinecal::detail
