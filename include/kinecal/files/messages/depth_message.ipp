// Depth from images, raw and compressed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/messages/message_rows.ipp"
#include "kinecal/files/messages/rvl_depth.ipp"
#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// The bytes of a sensor_msgs/CompressedImage; nullopt for other messages.
[[nodiscard]] inline std::optional<std::string_view> compressed(const MessageFields& message) {
  const MessageValue* data = field_at(message, "data");
  const auto* bytes = data == nullptr ? nullptr : data->as<Bytes>();
  if (field_at(message, "format") == nullptr || bytes == nullptr) return std::nullopt;
  return std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

/// A 16-bit PNG, or RVL, after the header of the transport compressedDepth: a 4-byte number, then a
/// and b for 32FC1, whose pixels are a / depth + b.
[[nodiscard]] inline DepthImage compressed_depth(std::string_view file, std::string_view format) {
  constexpr std::size_t kSettings = 12;
  constexpr float kMetre = 1000.0F;
  const bool metres = format.starts_with("32FC1");
  const bool rvl = format.find("rvl") != std::string_view::npos;
  float a = 0.0F, b = 0.0F;
  if (metres || format.find("compressedDepth") != std::string_view::npos) {
    ByteReader settings(as_bytes(file));
    settings.skip(4);
    a = settings.number<float>();
    b = settings.number<float>();
    file.remove_prefix(kSettings);
  }
  DepthImage depth = rvl ? decode_rvl(file) : decode_depth(file, "the image");
  if (!metres) return depth;
  for (float& z : depth.pixels) {
    const float near = std::round(z * kMetre) - b;
    z = near > 0.0F && a > 0.0F ? a / near : no_point().z();
  }
  return depth;
}

DepthImage depth_image(const MessageFields& message) {
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

bool is_depth(std::string_view encoding) {
  return encoding.starts_with("16UC1") || encoding.starts_with("32FC1");
}

}  // namespace kinecal::detail
