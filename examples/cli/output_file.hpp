// The one file that a command writes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kinecal::cli {

/// Refuses an output that is an input, and one that is there unless it may be replaced.
/// @throws OutputError  saying what to do
void check_output(const std::string& output, const std::vector<std::string>& inputs, bool force);

/// The folder of an output.
[[nodiscard]] std::filesystem::path folder_of(const std::string& output);

/// Writes the file whole or not at all; its folder is made where it is missing.
/// @throws OutputError  naming the file
void write_file(const std::string& output, const std::string& text);

}  // namespace kinecal::cli
