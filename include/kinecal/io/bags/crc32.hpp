// CRC-32 as in zip and zlib: polynomial 0x04C11DB7, bits mirrored, inverted at both ends.
//
// Eight bytes at a time: table k tells what a byte does that k more bytes follow, and the eight are
// added up.  Source: Kounavis and Berry, Novel Table Lookup-Based Algorithms for CRC Generation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

namespace detail {

using Crc32Tables = std::array<std::array<std::uint32_t, 256>, 8>;

[[nodiscard]] constexpr Crc32Tables crc32_tables() {
  constexpr std::uint32_t kPolynomial = 0xEDB88320u;
  Crc32Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ (rest & 1 ? kPolynomial : 0);
    tables[0][byte] = rest;
  }
  for (std::size_t k = 1; k < tables.size(); ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xFF];
    }
  }
  return tables;
}

inline constexpr Crc32Tables kCrc32Tables = crc32_tables();

}  // namespace detail

/// @param before  the sum of what stands before these bytes, 0 if nothing does
[[nodiscard]] inline std::uint32_t crc32(Bytes bytes, std::uint32_t before = 0) {
  const auto& t = detail::kCrc32Tables;
  std::uint32_t sum = ~before;
  const std::byte* at = bytes.data();
  std::size_t left = bytes.size();
  if constexpr (std::endian::native == std::endian::little) {
    for (; left >= 8; at += 8, left -= 8) {
      std::uint32_t a, b;
      std::memcpy(&a, at, 4);
      std::memcpy(&b, at + 4, 4);
      a ^= sum;
      sum = t[7][a & 0xFF] ^ t[6][(a >> 8) & 0xFF] ^ t[5][(a >> 16) & 0xFF] ^ t[4][a >> 24] ^
            t[3][b & 0xFF] ^ t[2][(b >> 8) & 0xFF] ^ t[1][(b >> 16) & 0xFF] ^ t[0][b >> 24];
    }
  }
  for (; left > 0; ++at, --left) {
    sum = (sum >> 8) ^ t[0][(sum ^ std::to_integer<std::uint32_t>(*at)) & 0xFF];
  }
  return ~sum;
}

}  // namespace kinecal
