// The single output file of a command.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"

namespace kinecal::cli {

/// Checks that an output can be written, is not an input, and does not exist or may be replaced.  With "-", the standard output is kept for it.
/// Remembers whether it was there: see existing_at().
/// @throws OutputError  if not
void check_output(const std::string& output, const std::vector<std::string>& inputs, bool force);

/// What becomes of a file of this name when the program writes it: kept if it has appeared since
/// check_output(), unless that was forced.  From then on the file is the program's own.
[[nodiscard]] Existing existing_at(const std::string& output);

/// write_text_file(), with existing_at().
/// @throws OutputError  naming the file
void write_output(const std::string& output, const std::string& content);

/// The same for a report, which replaces one that is there already.
void check_report(const std::string& output, const std::vector<std::string>& inputs, bool force);

/// The same for a report that is JSON, not a page.
void check_json(const std::string& output, const std::vector<std::string>& inputs);

/// The same for a page, which is HTML.
void check_page(const std::string& output, const std::vector<std::string>& inputs, bool force);

}  // namespace kinecal::cli
