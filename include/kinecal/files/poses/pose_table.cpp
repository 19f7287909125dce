// Definitions of pose_table.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/poses/pose_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/natural_order.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The words of a text between blanks, line ends, commas, semicolons and brackets; without comments and the p of a
/// pose of UR.
[[nodiscard]] std::vector<std::string> words_of_pose(const std::string& text) {
  std::vector<std::string> words(1);
  bool is_comment = false;
  for (const char c : text) {
    is_comment = (is_comment || c == '#' || c == '%') && c != '\n' && c != '\r';
    const bool separates =
        is_comment || std::string_view(" \t\r\n,;[]()").find(c) != std::string_view::npos;
    if (!separates) words.back() += c;
    if (separates && !words.back().empty()) words.emplace_back();
  }
  std::erase(words, "p");
  std::erase(words, "");
  return words;
}

/// The files of a folder with poses, in natural order.
/// @throws InputError  if it has none
[[nodiscard]] std::vector<std::string> pose_files(const std::string& folder) {
  std::map<std::string, std::vector<std::string>> by_ending;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    std::string ending = file.path().extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    static const std::set<std::string> kImages = {".png",  ".jpg",  ".jpeg", ".bmp", ".tif",
                                                  ".tiff", ".webp", ".npy",  ".pcd", ".ply"};
    if (file.is_regular_file() && !name.starts_with('.') && !kImages.contains(ending))
      by_ending[ending].push_back(name);
  }
  const auto most =
      std::max_element(by_ending.begin(), by_ending.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first == ".txt", a.second.size()) <
               std::pair(b.first == ".txt", b.second.size());
      });
  if (most == by_ending.end()) throw InputError(folder + ": has no text files with poses");
  std::sort(most->second.begin(), most->second.end(), file_naturally_before);
  return most->second;
}

/// A line with each pose of UR as six cells.
[[nodiscard]] std::string with_cells_of_ur(std::string line, char separator) {
  for (std::size_t at = line.find("p["); at != std::string::npos; at = line.find("p[", at)) {
    const std::size_t end = line.find(']', at);
    if (end == std::string::npos) break;
    std::string cells = line.substr(at + 2, end - at - 2);
    std::replace(cells.begin(), cells.end(), ',', separator);
    const bool is_quoted =
        at > 0 && line[at - 1] == '"' && end + 1 < line.size() && line[end + 1] == '"';
    line.replace(at - (is_quoted ? 1 : 0), end + 1 - at + (is_quoted ? 2 : 0), cells);
  }
  return line;
}

/// A text with poses of UR as tables have them.
[[nodiscard]] std::string with_cells_of_ur(const std::string& text) {
  const std::size_t first = text.find("p[");
  if (first == std::string::npos || text.find(']', first) == std::string::npos) return text;
  const std::size_t begin = text.find_last_of("\r\n", first) + 1;  // npos + 1 is 0
  std::string before = text.substr(begin, first - begin);
  std::erase(before, '"');
  while (before.ends_with(' ')) before.pop_back();
  const char separator = before.empty() ? ',' : before.back();
  if (separator != ',' && separator != ';' && separator != '\t')
    return text;  // not a cell of a table
  constexpr std::string_view kNames[] = {"x", "y", "z", "rx", "ry", "rz"};
  const std::string names = fmt::format("{}", fmt::join(kNames, std::string(1, separator)));
  std::string result, line;
  std::istringstream lines(text);
  bool is_above = true;
  while (std::getline(lines, line)) {
    if (line.ends_with('\r')) line.pop_back();
    const bool is_pose = line.find("p[") != std::string::npos;
    if (is_above && is_pose && result.empty() && before.empty()) result = names + "\n";
    is_above = is_above && !is_pose;
    if (is_above && !line.empty() &&
        !line.starts_with('#')) {  // a header: the name of the cell with the pose
      std::size_t cell = 0;
      for (auto cells = std::count(before.begin(), before.end(), separator);
           cells > 0 && cell != std::string::npos; --cells) {
        cell = line.find(separator, cell);
        if (cell != std::string::npos) ++cell;
      }
      if (cell != std::string::npos) line.replace(cell, line.find(separator, cell) - cell, names);
    }
    result += with_cells_of_ur(line, separator) + "\n";
  }
  return result;
}

}  // namespace
}  // namespace detail

bool is_pose_folder(const std::string& path) {
  std::error_code missing;
  return std::filesystem::is_directory(path, missing);
}

std::string read_pose_table(const std::string& path) {
  if (!is_pose_folder(path)) return detail::with_cells_of_ur(detail::read_text_file(path));
  const std::vector<std::string> names = detail::pose_files(path);
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
