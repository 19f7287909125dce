// The date of a calibration: in file names, and in readable form.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <filesystem>
#include <string>
#include <string_view>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// The date at the end of a name such as calibration_2026_11_21_20_47_57; empty if absent.
[[nodiscard]] inline std::string date_in_name(const std::string& stem) {
  const std::string shape = "_dddd_dd_dd_dd_dd_dd";
  if (stem.size() < shape.size()) return {};
  const std::string end = stem.substr(stem.size() - shape.size());
  const bool is_date = std::equal(end.begin(), end.end(), shape.begin(), [](char c, char s) {
    return s == 'd' ? c >= '0' && c <= '9' : c == s;
  });
  return is_date ? end.substr(1) : std::string();
}

/// The time at which a file was written, local time, Y_m_d_H_M_S.
[[nodiscard]] inline std::string date_of_file(const std::filesystem::path& path) {
  struct stat status = {};
  std::tm time = {};
  char text[64] = "";
  if (::stat(path.c_str(), &status) != 0 || ::localtime_r(&status.st_mtime, &time) == nullptr ||
      std::strftime(text, sizeof text, "%Y_%m_%d_%H_%M_%S", &time) == 0) {
    throw InputError(path.string() + ": the time at which it was written cannot be read");
  }
  return text;
}

/// A file's name with this date: depth_camera.yaml or depth_camera_<other date>.yaml becomes
/// depth_camera_<date>.yaml.
[[nodiscard]] inline std::string with_date(const std::string& name, const std::string& date) {
  const std::filesystem::path path(name);
  std::string stem = path.stem().string();
  if (const std::string old = date_in_name(stem); !old.empty()) {
    stem.resize(stem.size() - old.size() - 1);
  }
  return stem + "_" + date + path.extension().string();
}

/// "2026_11_21_20_47_57" as "2026-11-21 20:47:57".
[[nodiscard]] inline std::string date_for_people(std::string date) {
  constexpr std::string_view kSeparators = "-- ::";
  std::size_t at = 0;
  for (const char separator : kSeparators) {
    at = date.find('_', at);
    if (at == std::string::npos) break;
    date[at] = separator;
  }
  return date;
}

}  // namespace kinecal::detail
