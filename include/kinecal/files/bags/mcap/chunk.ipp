// Unpacks and checks a chunk of an MCAP file; its checksums.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>
#include <optional>
#include <string_view>

#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/mcap/records.ipp"

namespace kinecal::detail {

/// CRC-32 as in zip.
[[nodiscard]] inline std::uint32_t mcap_sum(Bytes bytes) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(crc32_z(0, data, bytes.size()));
}

/// @param expected  the sum in the file; 0 if unknown
/// @throws BytesError  if the bytes do not match their checksum
inline void check_mcap_sum(Bytes bytes, std::uint32_t expected, std::uint64_t place,
                           std::string_view what) {
  if (expected == 0) return;
  const std::uint32_t sum = mcap_sum(bytes);
  if (sum == expected) return;
  throw BytesError(
      fmt::format("byte {}: {} is damaged: its check sum is {:08x} and should be {:08x}", place,
                  what, sum, expected));
}

/// The records of a chunk.
/// @param unpack  receives them if they were compressed
/// @throws BytesError  if they are damaged, or this build lacks their compression
[[nodiscard]] inline Bytes unpack_mcap_chunk(const McapChunk& chunk, BlockUnpacker& unpack) {
  const std::optional<Compression> compression = compression_named(chunk.compression);
  if (!compression) {
    throw BytesError(
        fmt::format("compressed with '{}', which is not known; write it again with "
                    "zstd, lz4 or none",
                    chunk.compression));
  }
  const Bytes records = unpack(chunk.records, *compression, chunk.size);
  check_mcap_sum(records, chunk.sum, chunk.records_place, "its content");
  return records;
}

}  // namespace kinecal::detail
