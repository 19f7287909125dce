// Files of contact sheets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/tools/detect/contact_sheet.hpp"

namespace kinecal::cli {

/// Checks that contact sheets can be written: sheet.html, and sheet-2.html and so on if there are many views.
/// @throws OutputError  if one is an input, or exists and may not be replaced
void check_sheets(const std::string& output, const std::vector<std::string>& inputs, bool force);

/// Writes contact sheets.  Removes those of an earlier call that had more.
/// @returns  their names: "sheet.html, sheet-2.html"
/// @throws OutputError  naming the file
std::string write_sheets(const std::string& output, const std::vector<Thumbnail>& thumbnails);

}  // namespace kinecal::cli
