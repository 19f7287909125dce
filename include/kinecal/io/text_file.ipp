// Definitions of text_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

KINECAL_INLINE std::string read_text_file(const std::string& path) {
  std::error_code missing;  // reported below
  if (std::filesystem::is_directory(path, missing)) {
    throw InputError(path + ": is a folder, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path + ": cannot be read: " + std::generic_category().message(errno));
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace kinecal::detail
