// Reads a file as text, byte for byte; rejects what is not a file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinecal::detail {

/// Why a path cannot be read repeatedly from its beginning: it is a folder, or a pipe, which may
/// block forever.  Empty if it may be a file, even if it does not exist.
[[nodiscard]] std::string why_no_file(const std::string& path);

/// True for what can be read once only: the standard input, "-", and a pipe made by the shell: /dev/fd/63.
[[nodiscard]] bool is_stream(const std::string& path);

/// Reads a file or stream.  Streams are read once, and remembered: not from several threads.
/// @throws InputError  if the file is missing, is a folder or a named pipe, or cannot be read
[[nodiscard]] std::string read_text_file(const std::string& path);

}  // namespace kinecal::detail
