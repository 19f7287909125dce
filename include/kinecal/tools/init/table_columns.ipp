// The columns of a table, with what their names and values say: for proposed_columns.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/csv/csv_columns.hpp"
#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/csv/csv_units.hpp"

namespace kinecal::detail {

/// A column of a table.
struct TableColumn {
  std::string name;  ///< as in the header; its number, without one
  std::vector<std::string>
      words;  ///< of the name, small letters; digits at the end are a word of their own
  NamedUnit unit = NamedUnit::none;     ///< by the name
  bool per_second = false;              ///< the unit is one of a velocity: "deg/s"
  bool is_number = false;               ///< most cells are
  bool is_complete = false;             ///< every cell is a finite number
  double largest = 0.0;                 ///< of the values' magnitudes
  std::vector<double> values = {};      ///< of each row; NaN where there is none
  std::vector<std::string> texts = {};  ///< the same as text

  /// All words, joined: "shoulder_pan_joint".
  [[nodiscard]] std::string joined() const { return fmt::format("{}", fmt::join(words, "_")); }
};

/// A table as rows of the same number of cells.
struct ReadTable {
  char separator = ',';
  bool header = false;      ///< names of the columns are above the numbers
  std::string header_text;  ///< CsvTable::header_text()
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
  if (words.size() < 2) return NamedUnit::none;
  const NamedUnit unit = named_unit(words.back()).value_or(NamedUnit::none);
  if (unit == NamedUnit::unreadable) {
    throw InputError(
        fmt::format("{} looks like one in {}; kinecal reads metres, millimetres, "
                    "radians and degrees: convert it",
                    place, words.back()));
  }
  if (unit == NamedUnit::none || unit == NamedUnit::other) return NamedUnit::none;
  words.pop_back();
  return unit;
}

/// Reads the names, units and numbers of columns.
/// @throws InputError  if it is not a table with numbers
[[nodiscard]] inline ReadTable read_table(std::string_view text, const std::string& file) {
  ReadTable table;
  table.separator = csv_separator(text);
  Diagnostics diagnostics;
  const CsvTable read = csv_table(text, table.separator, CsvHeader::found, file, diagnostics);
  diagnostics.throw_if_errors();
  table.header = !read.header.cells.empty();
  table.header_text = read.header_text();
  if (read.rows.empty()) throw InputError(file + ": is not a table: it has no rows of numbers");
  for (std::size_t c = 0; c < read.columns; ++c) {
    TableColumn& column = table.columns.emplace_back();
    column.name = table.header ? read.header.cells[c] : fmt::format("{}", c + 1);
    if (table.header) column.words = words_of(column.name);
    const std::string place = fmt::format("{}: column '{}'", file, column.name);
    const auto take_units = [&] {
      column.per_second = column.per_second || take_per_second(column.words);
      if (column.unit == NamedUnit::none) column.unit = take_unit(column.words, place);
    };
    take_units();
    if (c < read.units.cells.size() && column.unit == NamedUnit::none) {
      const std::vector<std::string> unit = words_of(read.units.cells[c]);
      column.words.insert(column.words.end(), unit.begin(), unit.end());
      take_units();
    }
    std::size_t numbers = 0;
    for (const CsvRow& row : read.rows) {
      const auto value = c < row.cells.size() ? csv_number(row.cells[c]) : std::nullopt;
      column.texts.push_back(c < row.cells.size() ? row.cells[c] : "");
      column.values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
      if (!value || !std::isfinite(*value)) continue;
      ++numbers;
      column.largest = std::max(column.largest, std::abs(*value));
    }
    column.is_complete = numbers == read.rows.size();
    column.is_number = 2 * numbers >= read.rows.size();
  }
  return table;
}

}  // namespace kinecal::detail
