// Bag formats, identified by the first bytes of a file, whatever its name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <string_view>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal::detail {

/// First and last bytes of an MCAP file.
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
/// First bytes of an SQLite database.
inline constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
/// First bytes of a ROS 1 bag, before its version.
inline constexpr std::string_view kRos1Begin{"#ROSBAG V"};
/// First bytes of a zstd frame, little-endian.
inline constexpr std::string_view kZstdMagic{"\x28\xB5\x2F\xFD", 4};

[[nodiscard]] inline bool begins_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// True if a file is MCAP.
/// @param first  its first bytes, at least 16 unless it has fewer
[[nodiscard]] inline bool is_mcap(Bytes first) {
  return begins_with(first, kMcapMagic);
}
/// True if a file is an SQLite database, such as a .db3 bag.
/// @param first  its first bytes, at least 16 unless it has fewer
[[nodiscard]] inline bool is_sqlite(Bytes first) {
  return begins_with(first, kSqliteMagic);
}
/// True if a file is a bag of any kind, or packed.
/// @param first  its first bytes, at least 16 unless it has fewer
[[nodiscard]] inline bool is_bag(Bytes first) {
  return is_mcap(first) || is_sqlite(first) || begins_with(first, kZstdMagic) ||
         begins_with(first, kRos1Begin);
}

}  // namespace kinecal::detail
