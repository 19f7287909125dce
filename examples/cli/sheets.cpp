// SPDX-License-Identifier: Apache-2.0
#include "sheets.hpp"

#include <filesystem>

#include "kinecal/files/results/file_set.hpp"
#include "output_file.hpp"

namespace kinecal::cli {

void check_sheets(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  std::size_t number = 0;
  do {
    check_page(sheet_name(output, number++), inputs, force);
  } while (std::filesystem::exists(sheet_name(output, number)));
}

std::string write_sheets(const std::string& output, const std::vector<Thumbnail>& thumbnails) {
  const std::vector<std::string> sheets = contact_sheets(thumbnails);
  std::string names;
  for (std::size_t number = 0; number < sheets.size(); ++number) {
    const std::string name = sheet_name(output, number);
    write_output(name, sheets[number]);
    names += (names.empty() ? "" : ", ") + name;
  }
  for (std::size_t number = sheets.size(); number > 0; ++number) {
    std::error_code failed;
    if (!std::filesystem::remove(sheet_name(output, number), failed)) break;
  }
  return names;
}

}  // namespace kinecal::cli
