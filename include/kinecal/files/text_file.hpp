// A file as text, byte for byte; and what is not a file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinecal::detail {

/// Why a path is not a file that can be read from its beginning, as often as needed: a folder, or a
/// pipe, from which reading may wait for ever.  Empty if it may be one, also if it does not exist.
[[nodiscard]] std::string why_no_file(const std::string& path);

/// Reads a file, or a pipe that the shell made: /dev/stdin, /dev/fd/63.
/// @throws InputError  if the file is missing, is a folder or a named pipe, or cannot be read
[[nodiscard]] std::string read_text_file(const std::string& path);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/text_file.ipp"
#endif
