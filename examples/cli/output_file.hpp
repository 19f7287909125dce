// The single output file of a command.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinecal::cli {

/// Checks that an output can be written, is not an input, and does not exist or may be replaced.  With "-", the standard output is kept for it.
/// @throws OutputError  if not
void check_output(const std::string& output, const std::vector<std::string>& inputs, bool force);

/// The same for a page, which is HTML.
void check_page(const std::string& output, const std::vector<std::string>& inputs, bool force);

}  // namespace kinecal::cli
