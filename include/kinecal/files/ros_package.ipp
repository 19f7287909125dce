// Folders of ROS packages: recognised by their name or their package.xml, found among parents.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace kinecal::detail {

namespace fs = std::filesystem;

[[nodiscard]] inline bool is_folder(const fs::path& path) {
  std::error_code missing;
  return fs::is_directory(path, missing);
}

/// The path without links and dots; nullopt if it does not exist.
[[nodiscard]] inline std::optional<fs::path> canonical_path(const fs::path& path) {
  std::error_code wrong;
  fs::path found = fs::weakly_canonical(fs::absolute(path, wrong), wrong);
  if (wrong) return std::nullopt;
  if (!found.has_filename()) found = found.parent_path();  // "meshes/" becomes "meshes"
  return found;
}

/// True if the folder is the package, by its name or by the name in its package.xml.
[[nodiscard]] inline bool is_package(const fs::path& folder, const std::string& package) {
  if (!is_folder(folder)) return false;
  if (folder.filename() == package) return true;
  std::ifstream file(folder / "package.xml");
  constexpr std::size_t kMost = 65536;  // bytes
  std::string text(kMost, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return text.find("<name>" + package + "</name>") != std::string::npos;
}

/// The folder and its parents, nearest first.
[[nodiscard]] inline std::vector<fs::path> with_parents(const fs::path& folder) {
  std::vector<fs::path> all;
  const auto canonical = canonical_path(folder.empty() ? "." : folder);
  fs::path up = canonical.value_or(fs::path());
  for (; up.has_relative_path(); up = up.parent_path()) all.push_back(up);
  return all;
}

}  // namespace kinecal::detail
