// The standard output in place of a file, by the name "-".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinecal {

/// True for "-".
[[nodiscard]] bool is_standard_output(const std::string& path);

/// Keeps the standard output for what will be written to it: from here on, all else that is printed
/// there goes to the standard error.
void reserve_standard_output();

/// Writes to the standard output, reserved or not.
/// @throws OutputError  if it cannot be written completely
void write_standard_output(const std::string& content);

}  // namespace kinecal
