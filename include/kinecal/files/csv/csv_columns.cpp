// Definitions of csv_columns.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_columns.hpp"

#include <fmt/format.h>

#include <charconv>
#include <limits>

namespace kinecal::detail {

CsvColumns::CsvColumns(const CsvTable& table, Diagnostics& diagnostics)
    : header_(table.header.cells),
      header_text_(table.header_text()),
      columns_(table.columns),
      diagnostics_(diagnostics) {
  for (std::size_t i = 0; i < header_.size(); ++i) {
    if (!places_.try_emplace(header_[i], i).second) repeated_.insert(header_[i]);
  }
}

std::optional<std::size_t> CsvColumns::find(const CsvColumn& column) {
  auto same = places_.find(column.name);
  if (same == places_.end() && column.name.size() > 1 && column.name.starts_with('#')) {
    same = places_.find(column.name.substr(1));  // the mark of a comment
  }
  if (same != places_.end()) {
    if (repeated_.count(same->first) > 0) {
      error(column, "occurs twice in the table; give its number, from 1");
    }
    return same->second;
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
