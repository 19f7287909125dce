// A table of text: rows of cells, each row with its line number.
//
// RFC 4180 and its variants: commas, semicolons, tabs or spaces between cells, "quoted" cells in
// which "" is a quote, line ends of Unix, DOS and old Macs, a byte order mark, empty lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// A row of a table.
struct CsvRow {
  std::vector<std::string> cells;  ///< their text, without quotes
  int line = 0;                    ///< where it begins, from 1
};

/// The rows of a table, without empty ones.
/// @param separator  between cells; ' ' stands for one or more blanks, which align columns
/// @param file       name of the table in messages
[[nodiscard]] std::vector<CsvRow> csv_rows(std::string_view text, char separator,
                                           const std::string& file, Diagnostics& diagnostics);

}  // namespace kinecal::detail
