// The pieces of a scene's JSON: lists of numbers, poses, base64.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "kinecal/report/checksum.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/report/scene_text.hpp"

namespace kinecal::detail {

inline constexpr int kLengthDigits = 5;  ///< 0.01 mm
inline constexpr int kAngleDigits = 6;   ///< 0.06 mdeg

template <class Numbers>
[[nodiscard]] std::string numbers_json(const Numbers& numbers, int digits) {
  std::string json = "[";
  for (const double number : numbers) {
    json += (json.size() > 1 ? "," : "") + short_number(number, digits);
  }
  return json + "]";
}

/// [x, y, z, qx, qy, qz, qw]
[[nodiscard]] inline std::string pose_json(const Pose<double>& pose) {
  const Eigen::Vector4d q = quaternion(pose.rotation).normalized();
  const Vector3<double>& p = pose.translation;
  return fmt::format("[{},{},{},{},{},{},{}]", short_number(p.x(), kLengthDigits),
                     short_number(p.y(), kLengthDigits), short_number(p.z(), kLengthDigits),
                     short_number(q(0), kAngleDigits), short_number(q(1), kAngleDigits),
                     short_number(q(2), kAngleDigits), short_number(q(3), kAngleDigits));
}

/// A list; empty items are left out.
template <class Items, class Write>
[[nodiscard]] std::string compact_list(const Items& items, const Write& write) {
  std::string json = "[";
  for (const auto& item : items) {
    const std::string text = write(item);
    if (!text.empty()) json += (json.size() > 1 ? "," : "") + text;
  }
  return json + "]";
}

/// Numbers of four bytes, least significant byte first, as base64.
template <class T>
[[nodiscard]] std::string base64_of(const std::vector<T>& numbers) {
  static_assert(sizeof(T) == 4, "base64_of() writes float and uint32_t");
  std::string bytes;
  bytes.reserve(4 * numbers.size());
  for (const T number : numbers) {
    const auto word = std::bit_cast<std::uint32_t>(number);
    for (unsigned byte = 0; byte < 4; ++byte) {
      bytes += static_cast<char>((word >> (8 * byte)) & 255U);
    }
  }
  return base64(bytes);
}

}  // namespace kinecal::detail
