// The columns of a table, with what their names and values say: for proposed_columns.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/csv/csv_columns.hpp"
#include "kinecal/files/csv/csv_table.hpp"

namespace kinecal::detail {

/// The unit that a column's name has.
enum class NamedUnit { none, radians, degrees, metres, millimetres };

/// A column of a table.
struct TableColumn {
  std::string name;  ///< as in the header; its number, without one
  std::vector<std::string>
      words;  ///< of the name, small letters; digits at the end are a word of their own
  NamedUnit unit = NamedUnit::none;  ///< by the name
  bool per_second = false;           ///< the unit is one of a velocity: "deg/s"
  bool is_number = false;            ///< most cells are
  bool is_complete = false;          ///< every cell is a finite number
  double largest = 0.0;              ///< of the values' magnitudes

  /// All words, joined: "shoulder_pan_joint".
  [[nodiscard]] std::string joined() const { return fmt::format("{}", fmt::join(words, "_")); }
};

/// A table as rows of the same number of cells.
struct ReadTable {
  char separator = ',';
  bool header = false;  ///< the first row has names
  std::vector<TableColumn> columns;
};

/// "Shoulder_Pan_joint [deg]" -> shoulder pan joint deg; "q10" -> q 10.
[[nodiscard]] inline std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  const auto kind = [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return std::isalpha(u) != 0 || u >= 0x80 ? 1 : std::isdigit(u) != 0 ? 2 : 0;
  };
  int before = 0;
  for (const char c : name) {
    const int now = kind(c);
    if (now != 0) {
      if (now != before) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    before = now;
  }
  return words;
}

/// Takes "per second" off the words of a name, if a unit stands before it: "dq 1 deg s".
[[nodiscard]] inline bool take_per_second(std::vector<std::string>& words) {
  std::size_t left = words.size();
  if (left < 3 || (words[left - 1] != "s" && words[left - 1] != "sec")) return false;
  left -= words[left - 2] == "per" ? 2 : 1;
  const std::string& unit = words[left - 1];
  if (unit != "deg" && unit != "\u00b0" && unit != "rad" && unit != "m" && unit != "mm")
    return false;
  words.resize(left);
  return true;
}

/// Takes the unit off the words of a name.
/// @param place  "table.csv: column 'x [cm]'"
/// @throws InputError  if it is one that columns.yaml does not have
[[nodiscard]] inline NamedUnit take_unit(std::vector<std::string>& words,
                                         const std::string& place) {
  constexpr std::pair<std::string_view, NamedUnit> kUnits[] = {
      {"deg", NamedUnit::degrees},
      {"degree", NamedUnit::degrees},
      {"degrees", NamedUnit::degrees},
      {"\u00b0", NamedUnit::degrees},
      {"rad", NamedUnit::radians},
      {"radian", NamedUnit::radians},
      {"radians", NamedUnit::radians},
      {"mm", NamedUnit::millimetres},
      {"m", NamedUnit::metres},
      {"metres", NamedUnit::metres},
      {"meters", NamedUnit::metres},
      {"millimetres", NamedUnit::millimetres},
      {"millimeters", NamedUnit::millimetres}};
  if (words.size() < 2) return NamedUnit::none;
  for (const std::string_view other :
       {"cm", "dm", "um", "in", "inch", "inches", "ft", "grad", "gon", "mrad", "turns", "rev"}) {
    if (words.back() == other) {
      throw InputError(
          fmt::format("{} looks like one in {}; kinecal reads metres, millimetres, "
                      "radians and degrees: convert it",
                      place, other));
    }
  }
  for (const auto& [word, unit] : kUnits) {
    if (words.back() != word) continue;
    words.pop_back();
    return unit;
  }
  return NamedUnit::none;
}

/// The separator that makes most numbers of the same number of cells in every row.
[[nodiscard]] inline char separator_of(std::string_view text, const std::string& file) {
  char best = ',';
  std::size_t most = 0;
  for (const char separator : {',', ';', '\t', ' '}) {
    Diagnostics ignored;
    const std::vector<CsvRow> rows = csv_rows(text, separator, file, ignored);
    if (rows.size() < 2 || !ignored.errors.empty()) continue;
    const std::vector<std::string>& cells = rows[1].cells;
    if (std::any_of(rows.begin() + 1, rows.end(),
                    [&](const CsvRow& row) { return row.cells.size() != cells.size(); })) {
      continue;
    }
    const auto numbers =
        static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [&](std::string cell) {
          if (separator != ',') std::replace(cell.begin(), cell.end(), ',', '.');
          return csv_number(cell).has_value();
        }));
    if (numbers <= most) continue;
    most = numbers;
    best = separator;
  }
  return best;
}

/// @throws InputError  if it is not a table with numbers
[[nodiscard]] inline ReadTable read_table(std::string_view text, const std::string& file) {
  ReadTable table;
  table.separator = separator_of(text, file);
  Diagnostics diagnostics;
  const std::vector<CsvRow> rows = csv_rows(text, table.separator, file, diagnostics);
  diagnostics.throw_if_errors();
  if (rows.size() < 2) throw InputError(file + ": is not a table: it has fewer than two rows");
  const std::vector<std::string>& first = rows.front().cells;
  table.header = std::any_of(first.begin(), first.end(),
                             [](const std::string& cell) { return !csv_number(cell); });
  if (table.separator != ',') {
    for (const std::string& cell : rows[1].cells) {
      const std::size_t comma = cell.find(',');
      if (comma == std::string::npos) continue;
      std::string point = cell;
      point[comma] = '.';
      if (csv_number(point))
        throw InputError(fmt::format("{}:{}: '{}': write a decimal point, not a comma", file,
                                     rows[1].line, cell));
    }
  }
  for (std::size_t c = 0; c < first.size(); ++c) {
    TableColumn& column = table.columns.emplace_back();
    column.name = table.header ? first[c] : fmt::format("{}", c + 1);
    if (table.header) column.words = words_of(column.name);
    column.per_second = take_per_second(column.words);
    column.unit = take_unit(column.words, fmt::format("{}: column '{}'", file, column.name));
    std::size_t numbers = 0;
    for (std::size_t r = table.header ? 1 : 0; r < rows.size(); ++r) {
      if (c >= rows[r].cells.size()) continue;
      const auto value = csv_number(rows[r].cells[c]);
      if (!value || !std::isfinite(*value)) continue;
      ++numbers;
      column.largest = std::max(column.largest, std::abs(*value));
    }
    column.is_complete = numbers == rows.size() - (table.header ? 1 : 0);
    column.is_number = 2 * numbers >= rows.size() - (table.header ? 1 : 0);
  }
  return table;
}

}  // namespace kinecal::detail
