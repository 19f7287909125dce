// How the files of bags begin: that identifies their format, whatever their names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <string_view>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal::detail {

/// An MCAP file begins and ends with these bytes.
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
/// A database of SQLite begins with these bytes.
inline constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
/// One little-endian frame of zstd.
inline constexpr std::string_view kZstdMagic{"\x28\xB5\x2F\xFD", 4};

[[nodiscard]] inline bool begins_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// Whether a file is MCAP.
/// @param first  its first bytes, at least 16 if it has as many
[[nodiscard]] inline bool is_mcap(Bytes first) {
  return begins_with(first, kMcapMagic);
}
/// Whether a file is a database of SQLite, such as a .db3 bag.
/// @param first  its first bytes, at least 16 if it has as many
[[nodiscard]] inline bool is_sqlite(Bytes first) {
  return begins_with(first, kSqliteMagic);
}

}  // namespace kinecal::detail
