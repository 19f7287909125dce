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

/// The views of the contact sheets of an interrupted session, as HTML; empty if it wrote none.
/// @throws OutputError  if a file is no contact sheet
std::vector<std::string> read_sheets(const std::string& output);

/// Writes contact sheets.  Removes those of an earlier call that had more.
/// @param earlier  views that come first, of read_sheets()
/// @returns  their names: "sheet.html, sheet-2.html"
/// @throws OutputError  naming the file
std::string write_sheets(const std::string& output, const std::vector<Thumbnail>& thumbnails,
                         const std::vector<std::string>& earlier = {});

}  // namespace kinecal::cli
