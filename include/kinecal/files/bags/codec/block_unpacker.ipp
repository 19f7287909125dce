// Unpacks the blocks of a bag, and messages that ROS 2 compressed one by one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"
#include "kinecal/files/bags/formats.hpp"

namespace kinecal::detail {

/// Unpacks the blocks of a bag, one after the other.  Many small decompression bombs do as much
/// harm as a large one, so the total output is limited in proportion to the total input.
class BlockUnpacker {
 public:
  /// @return  the unpacked block, valid until the next one; `packed` if it is not compressed
  /// @throws BytesError  like unpack()
  [[nodiscard]] Bytes operator()(Bytes packed, Compression compression,
                                 std::optional<std::uint64_t> size) {
    if (compression == Compression::none) {
      check_size(packed, size);
      return packed;
    }
    unpack(packed, compression, size, unpacked_);
    read_ += packed.size();
    written_ += unpacked_.size();
    if (written_ <= most_unpacked_in_all(read_)) return unpacked_;
    throw BytesError("unpacks, with those before it, from " + byte_count(read_) + " to " +
                     std::to_string(written_) + ", which is not plausible");
  }

 private:
  std::vector<std::byte> unpacked_;
  std::uint64_t read_ = 0, written_ = 0;
};

/// In compression mode MESSAGE, ROS 2 compresses each message with zstd.  The first bytes identify
/// such messages, because CDR begins with a zero.
class MessageUnpacker {
 public:
  /// @return  the message, valid until the next one
  /// @throws BytesError  if it is damaged, or if this kinecal was built without zstd
  [[nodiscard]] Bytes operator()(const BagTopic& topic, Bytes data) {
    if (topic.encoding != Encoding::cdr || !begins_with(data, kZstdMagic)) return data;
    try {
      return unpack_(data, Compression::zstd, std::nullopt);
    } catch (const BytesError& e) {
      throw BytesError("a message of topic '" + topic.name + "' " + e.what());
    }
  }

 private:
  BlockUnpacker unpack_;
};

}  // namespace kinecal::detail
