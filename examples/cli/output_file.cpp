// SPDX-License-Identifier: Apache-2.0
#include "output_file.hpp"

#include <system_error>

#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "report.hpp"

namespace kinecal::cli {

void check_output(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  if (is_standard_output(output)) return reserve_standard_output();
  const auto name = [](const std::string& path) {
    return std::filesystem::absolute(path).lexically_normal();
  };
  for (const std::string& input : inputs) {
    if (input.empty()) continue;
    std::error_code missing;
    if (std::filesystem::equivalent(output, input, missing) || name(output) == name(input)) {
      throw OutputError(output + ": would replace an input; choose another name");
    }
  }
  if (std::filesystem::is_directory(output))
    throw OutputError(output + ": is a folder, not a file");
  const OutputFolder can_be_written(folder_of(output));
  if (force || !std::filesystem::exists(std::filesystem::symlink_status(output))) return;
  throw OutputError(output + ": exists; use --force to replace it, or choose another name");
}

void check_page(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  check_output(output, inputs, force);
  if (is_page(output)) return;
  throw OutputError(output + ": is written as HTML; let the name end in .html");
}

}  // namespace kinecal::cli
