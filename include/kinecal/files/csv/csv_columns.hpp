// The columns of a table by name or number, and the numbers in its cells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  [[nodiscard]] std::optional<std::size_t> find(const CsvColumn& column);

 private:
  void error(const CsvColumn& column, const std::string& what);

  std::vector<std::string> header_;
  std::size_t columns_;
  Diagnostics& diagnostics_;
};

/// The number in a cell, NaN if it is missing.
/// @return  nullopt if the cell contains anything else
[[nodiscard]] std::optional<double> csv_number(const std::string& cell);

}  // namespace kinecal::detail
