// Point clouds from sensor_msgs/PointCloud2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "kinecal/files/messages/message_rows.ipp"
#include "kinecal/files/messages/view_message.hpp"

namespace kinecal::detail {

/// Marks an absent field of a point.
inline constexpr std::size_t kNoField = 1 << 20;

/// Offset of a field in each point; kNoField if the cloud does not have it as a 4-byte number.
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

void read_cloud(const MessageFields& cloud, PointCloud& points, GrayImage& image) {
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
      image(u, v) =
          static_cast<std::uint8_t>(brightness((c >> 16) & kByte, (c >> 8) & kByte, c & kByte));
    }
  }
}

}  // namespace kinecal::detail
