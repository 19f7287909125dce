// Messages that ROS 2 compressed one by one: in its compression mode MESSAGE each is zstd.
//
// They are known by how they begin: CDR begins with a zero.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/bags/compression.hpp"
#include "kinecal/io/bags/ros2_formats.hpp"

namespace kinecal::detail {

class MessageUnpacker {
 public:
  /// @return  the message, valid up to the next one
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
