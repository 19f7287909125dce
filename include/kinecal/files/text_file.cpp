// Definitions of text_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/text_file.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <system_error>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

std::string why_no_file(const std::string& path) {
  std::error_code missing;
  const std::filesystem::file_status status = std::filesystem::status(path, missing);
  if (std::filesystem::is_directory(status)) return "is a folder, not a file";
  if (!std::filesystem::is_fifo(status) && !std::filesystem::is_socket(status)) return "";
  return "is a pipe, not a file; write its content to a file and give that";
}

bool is_stream(const std::string& path) {
  if (path == "-") return true;
  std::error_code missing;
  return path.starts_with("/dev/") && !std::filesystem::is_directory(path, missing) &&
         !why_no_file(path).empty();
}

std::string read_text_file(const std::string& path) {
  if (path == "-") {
    static const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    return text;
  }
  if (!is_stream(path)) {
    if (const std::string why = why_no_file(path); !why.empty()) {
      throw InputError(path + ": " + why);
    }
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path + ": cannot be read: " + std::generic_category().message(errno));
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace kinecal::detail
