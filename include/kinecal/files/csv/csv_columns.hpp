// The columns of a table by name or number, and the numbers in its cells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "kinecal/files/csv/csv_mapping.hpp"
#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// A table whose columns are found by name or number.
class CsvColumns {
 public:
  CsvColumns(const CsvTable& table, Diagnostics& diagnostics);

  /// The index of a column, from 0; an error and nullopt if there is no such column.
  [[nodiscard]] std::optional<std::size_t> find(const CsvColumn& column);

 private:
  void error(const CsvColumn& column, const std::string& what);

  std::vector<std::string> header_;
  std::unordered_map<std::string, std::size_t> places_;  ///< by name: the first column of it
  std::set<std::string> repeated_;                       ///< names of several columns
  std::string header_text_;                              ///< for messages
  std::size_t columns_;
  Diagnostics& diagnostics_;
};

/// The number in a cell, NaN if it is missing.
/// @return  nullopt if the cell contains anything else
[[nodiscard]] std::optional<double> csv_number(const std::string& cell);

}  // namespace kinecal::detail
