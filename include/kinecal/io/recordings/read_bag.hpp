// Bags of any format, told apart by what is in them and not by their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/bags/db3.hpp"
#include "kinecal/io/bags/mcap.hpp"
#include "kinecal/io/bags/ros1_bag.hpp"
#include "kinecal/io/bags/ros2_bag.hpp"
#include "kinecal/io/diagnostics.hpp"

namespace kinecal {

enum class RecordingFormat { yaml, ros1_bag, mcap, sqlite, ros2_bag, zstd };

/// The name of a format as messages say it.
[[nodiscard]] inline std::string_view to_string(RecordingFormat format) {
  constexpr std::array<std::string_view, 6> kNames = {
      "YAML", "ROS 1 bag", "MCAP", "ROS 2 bag (SQLite)", "ROS 2 bag", "ROS 2 bag (zstd)"};
  return kNames[static_cast<std::size_t>(format)];
}

/// The format of a file by its first bytes; folders are bags of ROS 2.  YAML is what is nothing
/// else, also where nothing can be read: whoever reads it then says so.
[[nodiscard]] inline RecordingFormat recording_format(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return RecordingFormat::ros2_bag;
  std::array<char, 16> first{};
  std::ifstream(path, std::ios::binary).read(first.data(), first.size());
  const Bytes bytes = std::as_bytes(std::span(first));
  if (is_mcap(bytes)) return RecordingFormat::mcap;
  if (is_sqlite(bytes)) return RecordingFormat::sqlite;
  if (detail::begins_with(bytes, kZstdMagic)) return RecordingFormat::zstd;
  const bool is_ros1 = std::string_view(first.data(), first.size()).starts_with("#ROSBAG V");
  if (is_ros1) return RecordingFormat::ros1_bag;
  return RecordingFormat::yaml;
}

/// Reads a bag of any format but YAML.
/// @param diagnostics  receives what is wrong with the bag; nothing is thrown for that
inline void read_bag(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  switch (recording_format(path)) {
    case RecordingFormat::ros1_bag:
      return read_ros1_bag(path, reader, diagnostics);
    case RecordingFormat::mcap:
      return read_mcap(path, reader, diagnostics);
    case RecordingFormat::sqlite:
      return read_db3(path, reader, diagnostics);
    case RecordingFormat::ros2_bag:
      return read_ros2_bag(path, reader, diagnostics);
    case RecordingFormat::zstd:
      return detail::read_ros2_bag_file(path, reader, diagnostics);
    case RecordingFormat::yaml:
      diagnostics.error({path, 0}, "is no bag");
  }
}

}  // namespace kinecal
