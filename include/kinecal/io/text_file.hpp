// A file as text, byte for byte.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "kinecal/io/diagnostics.hpp"

namespace kinecal {

/// @throws InputError  if the file is not there, is a folder or cannot be read
[[nodiscard]] inline std::string read_text_file(const std::filesystem::path& path) {
  std::error_code no_such_file;  // told below
  if (std::filesystem::is_directory(path, no_such_file)) {
    throw InputError(path.string() + ": is a folder, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path.string() + ": cannot be read: " + std::generic_category().message(errno));
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace kinecal
