// Definitions of csv_columns.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace kinecal::detail {

std::optional<std::size_t> CsvColumns::find(const CsvColumn& column) {
  auto same = std::find(header_.begin(), header_.end(), column.name);
  if (same == header_.end() && column.name.size() > 1 && column.name.starts_with('#')) {
    same =
        std::find(header_.begin(), header_.end(), column.name.substr(1));  // the mark of a comment
  }
  if (same != header_.end()) {
    if (std::find(same + 1, header_.end(), *same) != header_.end()) {
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
          fmt::format("is not in the table's header{}{}; {}",
                      columns_ == 1 ? ", which has one column: is the separator right?" : "",
                      did_you_mean(column.name, header_), header_text_));
  }
  return std::nullopt;
}

void CsvColumns::error(const CsvColumn& column, const std::string& what) {
  diagnostics_.error(column.place, fmt::format("column '{}' {}", column.name, what));
}

std::optional<double> csv_number(const std::string& cell) {
  for (const char* missing : {"", "-", "NA", "N/A", "n/a", "null", "NULL", "None"}) {
    if (cell == missing) return std::numeric_limits<double>::quiet_NaN();
  }
  return number_from_yaml(cell);
}

}  // namespace kinecal::detail
