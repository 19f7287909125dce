// A file as text, byte for byte.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinecal::detail {

/// Reads a file.
/// @throws InputError  if the file is missing, is a folder or cannot be read
[[nodiscard]] std::string read_text_file(const std::string& path);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/io/text_file.ipp"
#endif
