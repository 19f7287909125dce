// Definitions of text_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/text_file.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <system_error>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/text/characters.hpp"

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

namespace {

[[nodiscard]] std::string read_all(const std::string& path) {
  if (path == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path + ": cannot be read: " + std::generic_category().message(errno));
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::string read_text_file(const std::string& path) {
  if (path.find('\n') != std::string::npos) {
    throw InputError("'" + one_line(path) + "': the name of a file has a line end; rename it");
  }
  if (is_stream(path)) {
    static std::map<std::string, std::string> read;
    const auto known = read.find(path);
    return known != read.end() ? known->second : read.emplace(path, read_all(path)).first->second;
  }
  if (const std::string why = why_no_file(path); !why.empty()) {
    throw InputError(path + ": " + why);
  }
  return read_all(path);
}

}  // namespace kinecal::detail
