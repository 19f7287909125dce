// SPDX-License-Identifier: Apache-2.0
#include "output_file.hpp"

#include <map>
#include <system_error>
#include <utility>

#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "kinecal/text/characters.hpp"
#include "report.hpp"

namespace kinecal::cli {

namespace {

/// What becomes of files that are checked, by name.
std::map<std::string, Existing>& checked_outputs() {
  static std::map<std::string, Existing> all;
  return all;
}

}  // namespace

Existing existing_at(const std::string& output) {
  const auto [checked, is_new] = checked_outputs().try_emplace(output, Existing::replaced);
  return std::exchange(checked->second, Existing::replaced);
}

void write_output(const std::string& output, const std::string& content) {
  write_text_file(output, content, existing_at(output));
}

void check_output(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  if (is_standard_output(output)) return reserve_standard_output();
  if (output.find('\n') != std::string::npos) {
    throw OutputError("'" + detail::one_line(output) + "': the name of a file has a line end");
  }
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
  const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(output));
  checked_outputs().try_emplace(output, is_there || force ? Existing::replaced : Existing::kept);
  if (force || !is_there) return;
  throw OutputError(output + ": exists; use --force to replace it, or choose another name");
}

void check_report(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(output));
  check_output(output, inputs, force || is_there);
}

void check_json(const std::string& output, const std::vector<std::string>& inputs) {
  check_report(output, inputs, false);
  if (!is_page(output)) return;
  throw OutputError(output + ": is written as JSON; let the name end in .json");
}

void check_page(const std::string& output, const std::vector<std::string>& inputs, bool force) {
  check_output(output, inputs, force);
  if (is_page(output)) return;
  throw OutputError(output + ": is written as HTML; let the name end in .html");
}

}  // namespace kinecal::cli
