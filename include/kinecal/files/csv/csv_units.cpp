// Definitions of csv_units.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_units.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

namespace kinecal::detail {

std::optional<NamedUnit> named_unit(std::string_view word) {
  using enum NamedUnit;
  static constexpr std::pair<std::string_view, NamedUnit> kUnits[] = {{"deg", degrees},
                                                                      {"degree", degrees},
                                                                      {"degrees", degrees},
                                                                      {"\u00b0", degrees},
                                                                      {"rad", radians},
                                                                      {"radian", radians},
                                                                      {"radians", radians},
                                                                      {"mm", millimetres},
                                                                      {"millimetre", millimetres},
                                                                      {"millimetres", millimetres},
                                                                      {"millimeter", millimetres},
                                                                      {"millimeters", millimetres},
                                                                      {"m", metres},
                                                                      {"metre", metres},
                                                                      {"metres", metres},
                                                                      {"meter", metres},
                                                                      {"meters", metres},
                                                                      {"cm", unreadable},
                                                                      {"dm", unreadable},
                                                                      {"um", unreadable},
                                                                      {"\u00b5m", unreadable},
                                                                      {"in", unreadable},
                                                                      {"inch", unreadable},
                                                                      {"inches", unreadable},
                                                                      {"ft", unreadable},
                                                                      {"grad", unreadable},
                                                                      {"gon", unreadable},
                                                                      {"mrad", unreadable},
                                                                      {"turns", unreadable},
                                                                      {"rev", unreadable},
                                                                      {"s", other},
                                                                      {"sec", other},
                                                                      {"seconds", other},
                                                                      {"ms", other},
                                                                      {"us", other},
                                                                      {"ns", other},
                                                                      {"hz", other},
                                                                      {"n", other},
                                                                      {"nm", other},
                                                                      {"a", other},
                                                                      {"v", other},
                                                                      {"kg", other},
                                                                      {"c", other},
                                                                      {"\u00b0c", other},
                                                                      {"k", other},
                                                                      {"px", other},
                                                                      {"pixel", other},
                                                                      {"pixels", other},
                                                                      {"%", other}};
  const auto* const found = std::find_if(std::begin(kUnits), std::end(kUnits),
                                         [&](const auto& unit) { return unit.first == word; });
  return found == std::end(kUnits) ? std::nullopt : std::optional(found->second);
}

std::optional<NamedUnit> unit_of_cell(std::string_view cell) {
  const auto is_bracket = [](char c) {
    return std::string_view(" \t[](){}<>").find(c) != std::string_view::npos;
  };
  while (!cell.empty() && is_bracket(cell.front())) cell.remove_prefix(1);
  while (!cell.empty() && is_bracket(cell.back())) cell.remove_suffix(1);
  if (cell == "-" || cell == "1" || cell == "#") return NamedUnit::other;
  std::string word;
  std::transform(cell.begin(), cell.end(), std::back_inserter(word),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const std::string_view per_second : {"/s", "/sec"}) {
    if (word.ends_with(per_second)) word.resize(word.size() - per_second.size());
  }
  return named_unit(word);
}

bool are_units(const std::vector<std::string>& cells) {
  bool measures = false;
  for (const std::string& cell : cells) {
    if (cell.empty()) continue;
    const std::optional<NamedUnit> unit = unit_of_cell(cell);
    if (!unit) return false;
    measures = measures || *unit != NamedUnit::other;
  }
  return measures;
}

}  // namespace kinecal::detail
