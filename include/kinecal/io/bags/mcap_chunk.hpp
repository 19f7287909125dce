// What a chunk of an MCAP file holds, unpacked and checked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string_view>

#include "kinecal/io/bags/compression.hpp"
#include "kinecal/io/bags/crc32.hpp"
#include "kinecal/io/bags/mcap_records.hpp"

namespace kinecal::detail {

/// @param told  the sum that the file tells; 0 if it does not
/// @throws BytesError  if the bytes are others than those that were written
inline void check_mcap_sum(Bytes bytes, std::uint32_t told, std::uint64_t place,
                           std::string_view what) {
  if (told == 0) return;
  const std::uint32_t sum = crc32(bytes);
  if (sum == told) return;
  throw BytesError(
      fmt::format("byte {}: {} is damaged: its check sum is {:08x} and should be {:08x}", place,
                  what, sum, told));
}

/// The records of a chunk.
/// @param unpack  what they are kept in if they were compressed
/// @throws BytesError  if they are damaged, or compressed by what this kinecal lacks
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
