// The columns of a table by name or number, and the numbers in its cells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/csv/csv_mapping.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// A table whose columns are found by name or number.
class CsvColumns {
 public:
  /// @param header  names of the columns; empty if the table has none
  CsvColumns(std::vector<std::string> header, std::size_t columns, Diagnostics& diagnostics)
      : header_(std::move(header)), columns_(columns), diagnostics_(diagnostics) {}

  /// The index of a column, from 0; an error and nullopt if there is no such column.
  [[nodiscard]] std::optional<std::size_t> find(const CsvColumn& column) {
    const auto same = std::find(header_.begin(), header_.end(), column.name);
    if (same != header_.end()) {
      if (std::find(same + 1, header_.end(), column.name) != header_.end()) {
        error(column, "occurs twice in the table; give its number, from 1");
      }
      return same - header_.begin();
    }
    std::size_t number = 0;
    const char* const end = column.name.data() + column.name.size();
    const auto [stop, failed] = std::from_chars(column.name.data(), end, number);
    const bool is_number = failed == std::errc() && stop == end;
    if (is_number && number >= 1 && number <= columns_) return number - 1;
    if (is_number) {
      error(column, columns_ == 1
                        ? "does not exist; the table has 1 column: is the separator right?"
                        : fmt::format("does not exist; the table has columns 1 to {}", columns_));
    } else if (header_.empty()) {
      error(column, "is a name, but the table has no header; give its number, from 1");
    } else {
      error(column,
            fmt::format("is not in the table's header{}{}",
                        columns_ == 1 ? ", which has one column: is the separator right?" : "",
                        did_you_mean(column.name, header_)));
    }
    return std::nullopt;
  }

 private:
  void error(const CsvColumn& column, const std::string& what) {
    diagnostics_.error(column.place, fmt::format("column '{}' {}", column.name, what));
  }

  std::vector<std::string> header_;
  std::size_t columns_;
  Diagnostics& diagnostics_;
};

/// The number in a cell, NaN if it is missing.
/// @return  nullopt if the cell contains anything else
[[nodiscard]] inline std::optional<double> csv_number(const std::string& cell) {
  for (const char* missing : {"", "-", "NA", "N/A", "n/a", "null", "NULL", "None"}) {
    if (cell == missing) return std::numeric_limits<double>::quiet_NaN();
  }
  return number_from_yaml(cell);
}

}  // namespace kinecal::detail
