// Reads samples from a table: each row is a pose of the robot and its observations.
//
// A feature with a missing value becomes NaN and has no weight.  If its id is missing, too, it is
// skipped.  A row without a joint's position is skipped, with a warning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/csv/csv_mapping.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Samples from the text of a table.
/// @param file         name of the table in messages and in Sample::source
/// @param diagnostics  receives errors and warnings, each with "file:line: "
[[nodiscard]] std::vector<Sample> csv_samples(std::string_view text, const CsvMapping& mapping,
                                              const std::string& file, Diagnostics& diagnostics);

/// Reads samples from a table.  Collects all errors.
/// @param csv          the table
/// @param mapping      the meaning of its columns: csv_mapping.hpp
/// @param diagnostics  receives errors and warnings, each with "file:line: "
/// @throws InputError  if a file cannot be read
[[nodiscard]] std::vector<Sample> read_csv_samples(const std::string& csv,
                                                   const std::string& mapping,
                                                   Diagnostics& diagnostics);

/// True for a file that is a table rather than samples in YAML, by its ending and its text.
[[nodiscard]] bool is_csv_table(const std::string& path);

/// Reads samples from a table by the columns.yaml beside it, and notes that.
/// @throws InputError  if there is none, with the commands that propose one and convert the table
[[nodiscard]] std::vector<Sample> read_csv_by_columns_beside(const std::string& csv,
                                                             Diagnostics& diagnostics);

}  // namespace kinecal
