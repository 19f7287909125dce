// Definitions of pose_table.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/poses/pose_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "kinecal/files/natural_order.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The words of a text between blanks, line ends, commas, semicolons and brackets.
[[nodiscard]] std::vector<std::string> words_of_pose(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    const bool separates = std::string_view(" \t\r\n,;[]()").find(c) != std::string_view::npos;
    if (!separates) words.back() += c;
    if (separates && !words.back().empty()) words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

}  // namespace
}  // namespace detail

bool is_pose_folder(const std::string& path) {
  std::error_code missing;
  return std::filesystem::is_directory(path, missing);
}

std::string read_pose_table(const std::string& path) {
  if (!is_pose_folder(path)) return detail::read_text_file(path);
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(path)) {
    if (file.path().extension() == ".txt") names.push_back(file.path().filename().string());
  }
  if (names.empty()) throw InputError(path + ": has no .txt files with poses");
  std::sort(names.begin(), names.end(), file_naturally_before);
  std::string header = "image", rows;
  std::size_t numbers = 0;
  for (const std::string& name : names) {
    const std::filesystem::path file = std::filesystem::path(path) / name;
    const auto words = detail::words_of_pose(detail::read_text_file(file.string()));
    if (numbers == 0) numbers = words.size();
    if (words.size() != numbers || words.empty()) {
      throw InputError(fmt::format("{}: has {}, but {} has {}", file.string(),
                                   counted(words.size(), "number"), names.front(), numbers));
    }
    rows += fmt::format("\"{}\",{}\n", file.stem().string(), fmt::join(words, ","));
  }
  for (std::size_t i = 1; i <= numbers; ++i) header += fmt::format(",{}", i);
  return header + "\n" + rows;
}

}  // namespace kinecal
