// A table of text: rows of cells, each row with its line number.
//
// RFC 4180 and its variants: commas, semicolons, tabs or spaces between cells, "quoted" cells in
// which "" is a quote, line ends of Unix, DOS and old Macs, a byte order mark, empty lines.
// What stands above the rows is not always a header: lines that begin with #, % or // are comments, of
// which the last may name the columns (numpy.savetxt, TUM), and titles, settings and rows of groups
// precede the names in what Motive, Qualisys, Vicon, Leica and spreadsheets write.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// A row of a table.
struct CsvRow {
  std::vector<std::string> cells;  ///< their text, without quotes
  int line = 0;                    ///< where it begins, from 1
  bool is_comment = false;         ///< begins with #, % or //, the mark in its first cell
};

/// Whether the columns of a table have names.
enum class CsvHeader : std::uint8_t {
  present,  ///< the first row, if none looks like one
  absent,
  found  ///< if a row or a comment above the numbers looks like one
};

/// A table: the names of its columns, their units, and rows.
struct CsvTable {
  CsvRow header;             ///< no cells: without names
  CsvRow units;              ///< of a row of units below the header; no cells without one
  std::vector<CsvRow> rows;  ///< numbers with decimal points
  std::size_t columns = 0;   ///< of the header, else the most of a row

  /// "line 3: 'j1, j2, x'", for messages about names
  [[nodiscard]] std::string header_text() const;
};

/// Reads what is a table in a text.  A decimal comma is read where commas do not separate cells: in columns in
/// which no number has a point.  A row of numbers that is commented out is a warning.
/// @param separator  like that of csv_rows()
[[nodiscard]] CsvTable csv_table(std::string_view text, char separator, CsvHeader header,
                                 const std::string& file, Diagnostics& diagnostics);

/// The separator with which most cells of a text's rows are numbers.
[[nodiscard]] char csv_separator(std::string_view text);

/// The rows of a text, without empty ones.
/// @param separator  between cells; ' ' stands for one or more blanks, which align columns
/// @param file       name of the table in messages
[[nodiscard]] std::vector<CsvRow> csv_rows(std::string_view text, char separator,
                                           const std::string& file, Diagnostics& diagnostics);

}  // namespace kinecal::detail
