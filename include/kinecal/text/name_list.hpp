// Lists of names in one word: a,b.  A comma of a name is \, and a backslash \\.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kinecal {

/// A name as an entry of a list.
[[nodiscard]] inline std::string list_entry(std::string_view name) {
  std::string entry;
  for (const char c : name) {
    if (c == ',' || c == '\\') entry += '\\';
    entry += c;
  }
  return entry;
}

/// The names of a list, empty ones left out.  A backslash before another character is one of the name.
[[nodiscard]] inline std::vector<std::string> names_of_list(std::string_view list) {
  std::vector<std::string> names = {""};
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool is_escape =
        list[i] == '\\' && i + 1 < list.size() && (list[i + 1] == ',' || list[i + 1] == '\\');
    if (is_escape) {
      names.back() += list[++i];
    } else if (list[i] == ',') {
      names.emplace_back();
    } else {
      names.back() += list[i];
    }
  }
  std::erase(names, "");
  return names;
}

}  // namespace kinecal
