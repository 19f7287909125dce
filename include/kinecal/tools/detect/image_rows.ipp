// Which row of a table belongs to which image: for image_folder.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/natural_order.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/image_folder.hpp"

namespace kinecal::detail {

/// Adds to the names of text files the endings of their images.
inline void complete_names(const std::vector<std::string>& images, std::vector<CsvRow>& rows) {
  for (CsvRow& row : rows) {
    for (const std::string& image : images) {
      if (std::filesystem::path(image).stem() == row.cells.front()) row.cells.front() = image;
    }
  }
}

/// Assigns images to rows.
/// @param image  column of their names; nullopt: the order of their names
/// @return       by the source of each row
[[nodiscard]] inline std::map<std::string, std::string> images_of_rows(
    const std::vector<CsvRow>& rows, bool header, std::optional<std::size_t> image,
    const ImageFolder& folder, const std::vector<std::string>& names, Diagnostics& diagnostics) {
  std::map<std::string, std::string> result;
  std::set<std::string> used;
  const std::size_t first = header ? 1 : 0;
  for (std::size_t i = first; i < rows.size(); ++i) {
    const SourceLocation place{folder.table, rows[i].line};
    std::string name;
    if (image && *image < rows[i].cells.size()) name = rows[i].cells[*image];
    if (!image && i - first < names.size()) name = names[i - first];
    const std::string file = std::filesystem::path(name).filename().string();
    if (!image && name.empty()) {
      diagnostics.error(place, "there is no image for this row: the table has " +
                                   std::to_string(rows.size() - first) + " rows, " + folder.images +
                                   " has " + std::to_string(names.size()) + " images");
    } else if (!std::binary_search(names.begin(), names.end(), file, file_naturally_before)) {
      diagnostics.error(place, "image '" + printable(name) + "' is not in " + folder.images +
                                   did_you_mean(file, names));
    } else if (!used.insert(file).second) {
      diagnostics.error(place, "image '" + printable(name) + "' has a row already");
    } else {
      result[place.str()] = file;
    }
  }
  for (const std::string& name : names) {
    if (used.count(name) > 0) continue;
    diagnostics.error({folder.table, 0},
                      "has no row for image " + printable(name) + " of " + folder.images);
  }
  return result;
}

}  // namespace kinecal::detail
