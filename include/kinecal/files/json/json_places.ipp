// Where the numbers of a JSON text are, so that one can be replaced and all else stays.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/json/json_value.hpp"

namespace kinecal::detail {

/// Begin and end of a number in a text.
struct NumberPlace {
  std::size_t begin, end;
};

/// The numbers of the objects in an object, by the two names: {"elbow": {"id": 3}} has ("elbow", "id").
/// @param text  JSON, as JsonValue::parse() took it
[[nodiscard]] inline std::map<std::pair<std::string, std::string>, NumberPlace> number_places(
    std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  std::map<std::pair<std::string, std::string>, NumberPlace> places;
  std::vector<std::string> names(3);  // of the fields that the position is in, by depth
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (c != '"') continue;
    const std::size_t begin = at++;
    while (text[at] != '"') at += text[at] == '\\' ? 2 : 1;
    const std::size_t colon = text.find_first_not_of(kSpace, at + 1);
    if (colon >= text.size() || text[colon] != ':' || depth >= names.size()) continue;
    const std::string_view quoted = text.substr(begin, at + 1 - begin);
    names[depth] = JsonValue::parse(quoted).as_text();
    const std::size_t value = text.find_first_not_of(kSpace, colon + 1);
    const std::size_t end = text.find_first_of(",}] \t\r\n", value);
    const bool is_number = text[value] == '-' || (text[value] >= '0' && text[value] <= '9');
    if (depth == 2 && is_number) places[{names[1], names[2]}] = {value, end};
  }
  return places;
}

}  // namespace kinecal::detail
