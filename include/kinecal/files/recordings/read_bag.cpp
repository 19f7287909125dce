// Definitions of read_bag.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/read_bag.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/read_mcap.hpp"
#include "kinecal/files/bags/ros1/read_bag.hpp"
#include "kinecal/files/bags/rosbag2/read_bag.hpp"
#include "kinecal/files/bags/rosbag2/read_db3.hpp"
#include "kinecal/files/text_file.hpp"

namespace kinecal {

std::string_view to_string(RecordingFormat format) {
  constexpr std::array<std::string_view, 6> kNames = {
      "YAML", "ROS 1 bag", "MCAP", "ROS 2 bag (SQLite)", "ROS 2 bag", "ROS 2 bag (zstd)"};
  return kNames[static_cast<std::size_t>(format)];
}

RecordingFormat recording_format(const std::string& path) {
  if (detail::is_stream(path)) return RecordingFormat::yaml;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return RecordingFormat::ros2_bag;
  if (!detail::why_no_file(path).empty()) return RecordingFormat::yaml;
  std::array<char, 16> first{};
  std::ifstream(path, std::ios::binary).read(first.data(), first.size());
  const Bytes bytes = std::as_bytes(std::span(first));
  if (detail::is_mcap(bytes)) return RecordingFormat::mcap;
  if (detail::is_sqlite(bytes)) return RecordingFormat::sqlite;
  if (detail::begins_with(bytes, detail::kZstdMagic)) return RecordingFormat::zstd;
  return detail::begins_with(bytes, detail::kRos1Begin) ? RecordingFormat::ros1_bag
                                                        : RecordingFormat::yaml;
}

void read_bag(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
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
    case RecordingFormat::yaml: {
      std::error_code ignored;
      const bool exists = std::filesystem::exists(path, ignored);
      diagnostics.error({path, 0}, exists ? "is not a bag" : "does not exist");
    }
  }
}

}  // namespace kinecal
