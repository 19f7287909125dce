// SPDX-License-Identifier: Apache-2.0
#include "sheets.hpp"

#include <filesystem>

#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "output_file.hpp"

namespace kinecal::cli {

void check_sheets(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  std::size_t number = 0;
  do {
    check_page(sheet_name(output, number++), inputs, force);
  } while (std::filesystem::exists(sheet_name(output, number)));
}

std::vector<std::string> read_sheets(const std::string& output) {
  std::vector<std::string> views;
  for (std::size_t number = 0; std::filesystem::exists(sheet_name(output, number)); ++number) {
    const std::string name = sheet_name(output, number);
    const auto found = views_of_sheet(detail::read_text_file(name));
    if (!found) {
      throw OutputError(name +
                        ": exists and is no contact sheet of this program, so --resume does not "
                        "replace it; choose another name");
    }
    views.insert(views.end(), found->begin(), found->end());
  }
  return views;
}

std::string write_sheets(const std::string& output, const std::vector<Thumbnail>& thumbnails,
                         const std::vector<std::string>& earlier) {
  const std::vector<std::string> sheets = contact_sheets(thumbnails, earlier);
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
