// Images and depth from their messages, raw and compressed.
// Source: packages sensor_msgs, cv_bridge (names of encodings), compressed_depth_image_transport; REP
// 118 (depth images).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bridge/message_fields.ipp"
#include "kinecal/io/images/read_image.hpp"
#include "kinecal/io/printable.hpp"

namespace kinecal::detail {

/// Rows of pixels or points in a message.
struct MessageRows {
  int width = 0, height = 0;
  std::size_t step = 0;  ///< bytes of a row
  Bytes data;
  std::endian order = std::endian::little;

  /// What follows a byte of a row.
  [[nodiscard]] ByteReader at(int row, std::size_t byte) const {
    return ByteReader(data.subspan(static_cast<std::size_t>(row) * step + byte), order);
  }
};

/// @param item  bytes of a pixel or point
/// @throws BytesError  if the data has another size than its rows
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

/// Pixels of an encoding: their bytes, and where red, green and blue are; the same if it is gray.
struct PixelForm {
  std::string_view name;
  std::size_t bytes, red, green, blue;
};

inline constexpr std::array kPixelForms = {
    PixelForm{"mono8", 1, 0, 0, 0}, PixelForm{"8UC1", 1, 0, 0, 0}, PixelForm{"rgb8", 3, 0, 1, 2},
    PixelForm{"8UC3", 3, 2, 1, 0},  PixelForm{"bgr8", 3, 2, 1, 0}, PixelForm{"rgba8", 4, 0, 1, 2},
    PixelForm{"bgra8", 4, 2, 1, 0}, PixelForm{"8UC4", 4, 2, 1, 0}};

/// Brightness of a colour, by the weights of ITU-R BT.601.
[[nodiscard]] inline std::uint8_t brightness(unsigned red, unsigned green, unsigned blue) {
  return static_cast<std::uint8_t>((299 * red + 587 * green + 114 * blue + 500) / 1000);
}

/// The bytes of a sensor_msgs/CompressedImage; nullopt of other messages.
[[nodiscard]] inline std::optional<std::string_view> compressed(const MessageFields& message) {
  const MessageValue* data = field_at(message, "data");
  const auto* bytes = data == nullptr ? nullptr : data->as<Bytes>();
  if (field_at(message, "format") == nullptr || bytes == nullptr) return std::nullopt;
  return std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

/// @throws std::runtime_error  if the encoding is not one of gray or colour images
[[nodiscard]] inline GrayImage gray_image(const MessageFields& message) {
  if (const auto file = compressed(message)) return decode_image(*file, "the image");
  const std::string_view encoding = text_at(message, "encoding");
  if (encoding == "mono16" || encoding == "16UC1") {
    const MessageRows rows = rows_of(message, "step", 2);
    GrayImage image(rows.width, rows.height);
    for (int v = 0; v < rows.height; ++v) {
      ByteReader row = rows.at(v, 0);
      constexpr int kUpperByte = 8;
      for (int u = 0; u < rows.width; ++u) {
        image(u, v) = static_cast<std::uint8_t>(row.number<std::uint16_t>() >> kUpperByte);
      }
    }
    return image;
  }
  for (const PixelForm& form : kPixelForms) {
    if (form.name != encoding) continue;
    const MessageRows rows = rows_of(message, "step", form.bytes);
    GrayImage image(rows.width, rows.height);
    for (int v = 0; v < rows.height; ++v) {
      const std::byte* pixel = rows.data.data() + static_cast<std::size_t>(v) * rows.step;
      for (int u = 0; u < rows.width; ++u, pixel += form.bytes) {
        image(u, v) = brightness(std::to_integer<unsigned>(pixel[form.red]),
                                 std::to_integer<unsigned>(pixel[form.green]),
                                 std::to_integer<unsigned>(pixel[form.blue]));
      }
    }
    return image;
  }
  throw std::runtime_error("images of encoding '" + printable(encoding) + "' are not supported");
}

/// A PNG of 16 bits, after the settings that the transport compressedDepth puts before it.
[[nodiscard]] inline DepthImage compressed_depth(std::string_view file, std::string_view format) {
  if (format.starts_with("32FC1")) {
    throw std::runtime_error("compressed depth of encoding 32FC1 is not supported; expected 16UC1");
  }
  constexpr std::size_t kSettings = 12;
  if (format.find("compressedDepth") != std::string_view::npos) {
    file.remove_prefix(std::min(kSettings, file.size()));
  }
  return decode_depth(file, "the image");
}

/// Metres (32FC1) or millimetres (16UC1, 0: not measured).
/// @throws std::runtime_error  if the encoding is not one of depth
[[nodiscard]] inline DepthImage depth_image(const MessageFields& message) {
  if (const auto file = compressed(message)) {
    return compressed_depth(*file, text_at(message, "format"));
  }
  const std::string_view encoding = text_at(message, "encoding");
  const bool metres = encoding == "32FC1";
  if (!metres && encoding != "16UC1" && encoding != "mono16") {
    throw std::runtime_error("depth of encoding '" + printable(encoding) +
                             "' is not supported; expected 16UC1 or 32FC1");
  }
  const MessageRows rows = rows_of(message, "step", metres ? sizeof(float) : 2);
  DepthImage depth(rows.width, rows.height);
  for (int v = 0; v < rows.height; ++v) {
    ByteReader row = rows.at(v, 0);
    for (int u = 0; u < rows.width; ++u) {
      constexpr float kMillimetre = 1e-3F;
      const float z = metres ? row.number<float>()
                             : static_cast<float>(row.number<std::uint16_t>()) * kMillimetre;
      depth(u, v) = z > 0.0F && std::isfinite(z) ? z : no_point().z();
    }
  }
  return depth;
}

}  // namespace kinecal::detail
