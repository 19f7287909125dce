// Rows of pixels or points in a message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/messages/message_fields.ipp"

namespace kinecal::detail {

/// Rows of pixels or points in a message.
struct MessageRows {
  int width = 0, height = 0;
  std::size_t step = 0;  ///< bytes of a row
  Bytes data;
  std::endian order = std::endian::little;

  /// The bytes of a row from some byte on.
  [[nodiscard]] ByteReader at(int row, std::size_t byte) const {
    return ByteReader(data.subspan(static_cast<std::size_t>(row) * step + byte), order);
  }
};

/// @param item  bytes of a pixel or point
/// @throws BytesError  if the size of the data does not match its rows
[[nodiscard]] inline MessageRows rows_of(const MessageFields& message, const char* step,
                                         std::size_t item) {
  constexpr double kMost = 1 << 16;
  const double width = number_at(message, "width"), height = number_at(message, "height");
  const MessageValue* data = field_at(message, "data");
  const auto* bytes = data == nullptr ? nullptr : data->as<Bytes>();
  MessageRows rows;
  const bool fits = width >= 1 && width <= kMost && height >= 1 && height <= kMost;
  if (fits && bytes != nullptr) {
    rows.width = static_cast<int>(width);
    rows.height = static_cast<int>(height);
    rows.step = static_cast<std::size_t>(number_at(message, step));
    rows.data = *bytes;
    rows.order = number_at(message, "is_bigendian") != 0.0 ? std::endian::big : std::endian::little;
    const std::size_t needed = rows.step * static_cast<std::size_t>(rows.height);
    if (rows.step >= item * static_cast<std::size_t>(rows.width) && bytes->size() >= needed) {
      return rows;
    }
  }
  throw BytesError("an image or cloud of " + std::to_string(static_cast<std::int64_t>(width)) +
                   "x" + std::to_string(static_cast<std::int64_t>(height)) + " does not fit in " +
                   byte_count(bytes == nullptr ? 0 : bytes->size()));
}

/// Brightness of a colour, with the weights of ITU-R BT.601.
[[nodiscard]] inline unsigned brightness(unsigned red, unsigned green, unsigned blue) {
  return (299 * red + 587 * green + 114 * blue + 500) / 1000;
}

}  // namespace kinecal::detail
