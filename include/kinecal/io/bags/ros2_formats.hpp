// How ROS 2's bags begin, and what they call topics and types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

/// An MCAP file begins and ends with these bytes.
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
/// One little-endian frame of zstd.
inline constexpr std::string_view kZstdMagic{"\x28\xB5\x2F\xFD", 4};

namespace detail {

[[nodiscard]] inline bool begins_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

}  // namespace detail

/// @param first  of the file, at least 16 bytes if it has as many
[[nodiscard]] inline bool is_mcap(Bytes first) {
  return detail::begins_with(first, kMcapMagic);
}
[[nodiscard]] inline bool is_sqlite(Bytes first) {
  return detail::begins_with(first, kSqliteMagic);
}

namespace detail {

/// "sensor_msgs/JointState" is "sensor_msgs/msg/JointState".
[[nodiscard]] inline std::string ros2_type(std::string_view type) {
  const std::size_t at = type.find('/');
  if (at == std::string_view::npos || type.find('/', at + 1) != std::string_view::npos) {
    return std::string(type);
  }
  return std::string(type.substr(0, at)) + "/msg" + std::string(type.substr(at));
}

}  // namespace detail

}  // namespace kinecal
