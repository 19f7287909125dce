// Images, clouds and camera settings from their messages.
// Source: packages sensor_msgs, cv_bridge (names of encodings), REP 118 (depth images).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bridge/message_fields.ipp"
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

/// @throws std::runtime_error  if the encoding is not one of gray or colour images
[[nodiscard]] inline GrayImage gray_image(const MessageFields& message) {
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

/// Metres (32FC1) or millimetres (16UC1, 0: not measured).
/// @throws std::runtime_error  if the encoding is not one of depth
[[nodiscard]] inline DepthImage depth_image(const MessageFields& message) {
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

/// No field of a point.
inline constexpr std::size_t kNoField = 1 << 20;

/// Byte of a field in each point; kNoField if the cloud does not have it as a 4-byte number.
[[nodiscard]] inline std::size_t point_field(const MessageFields& cloud, std::string_view name) {
  constexpr double kUint32 = 6, kFloat32 = 7;
  for (const MessageValue& item : list_at(cloud, "fields")) {
    const auto* field = item.as<MessageFields>();
    if (field == nullptr || text_at(*field, "name") != name) continue;
    const double type = number_at(*field, "datatype");
    if (type != kUint32 && type != kFloat32) continue;
    return static_cast<std::size_t>(number_at(*field, "offset"));
  }
  return kNoField;
}

[[nodiscard]] inline float float_at(const MessageRows& rows, int row, std::size_t byte) {
  return rows.at(row, byte).number<float>();
}

/// Points, and colour as brightness if there is any and the image is empty.
/// @throws std::runtime_error  if it has no x, y, z
inline void read_cloud(const MessageFields& cloud, PointCloud& points, GrayImage& image) {
  const std::size_t x = point_field(cloud, "x"), y = point_field(cloud, "y"),
                    z = point_field(cloud, "z");
  const std::size_t rgb = std::min(point_field(cloud, "rgb"), point_field(cloud, "rgba"));
  const auto point_step = static_cast<std::size_t>(number_at(cloud, "point_step"));
  if (std::max({x, y, z}) + sizeof(float) > point_step) {
    throw std::runtime_error("the cloud has no float32 fields x, y, z within its points");
  }
  const MessageRows rows = rows_of(cloud, "row_step", point_step);
  const bool has_colour = image.empty() && rgb + sizeof(float) <= point_step;
  points = PointCloud(rows.width, rows.height, no_point());
  if (has_colour) image = GrayImage(rows.width, rows.height);
  for (int v = 0; v < rows.height; ++v) {
    for (int u = 0; u < rows.width; ++u) {
      const std::size_t at = static_cast<std::size_t>(u) * point_step;
      const float px = float_at(rows, v, at + x), py = float_at(rows, v, at + y),
                  pz = float_at(rows, v, at + z);
      if (std::isfinite(px) && std::isfinite(py) && std::isfinite(pz)) points(u, v) << px, py, pz;
      if (!has_colour) continue;
      constexpr unsigned kByte = 0xff;
      const auto c = rows.at(v, at + rgb).number<std::uint32_t>();
      image(u, v) = brightness((c >> 16) & kByte, (c >> 8) & kByte, c & kByte);
    }
  }
}

}  // namespace kinecal::detail
