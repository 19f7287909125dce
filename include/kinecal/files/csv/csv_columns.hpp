// The columns of a table by name or number, and the numbers in its cells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/csv/csv_mapping.hpp"
#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// A table whose columns are found by name or number.
class CsvColumns {
 public:
  CsvColumns(const CsvTable& table, Diagnostics& diagnostics)
      : header_(table.header.cells),
        header_text_(table.header_text()),
        columns_(table.columns),
        diagnostics_(diagnostics) {}

  /// The index of a column, from 0; an error and nullopt if there is no such column.
  [[nodiscard]] std::optional<std::size_t> find(const CsvColumn& column);

 private:
  void error(const CsvColumn& column, const std::string& what);

  std::vector<std::string> header_;
  std::string header_text_;  ///< for messages
  std::size_t columns_;
  Diagnostics& diagnostics_;
};

/// The number in a cell, NaN if it is missing.
/// @return  nullopt if the cell contains anything else
[[nodiscard]] std::optional<double> csv_number(const std::string& cell);

}  // namespace kinecal::detail
