// The pieces of a scene's JSON: lists of numbers, poses, base64.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal::detail {

inline constexpr int kLengthDigits = 5;  ///< 0.01 mm
inline constexpr int kAngleDigits = 6;   ///< 0.06 mdeg

template <class Numbers>
[[nodiscard]] Json rounded_list(const Numbers& numbers, int digits) {
  Json list = Json::array();
  for (const double number : numbers) list.push_back(rounded(number, digits));
  return list;
}

/// [x, y, z, qx, qy, qz, qw]
[[nodiscard]] inline Json pose_json(const Pose<double>& pose) {
  const Eigen::Vector4d q = quaternion(pose.rotation).normalized();
  Json json = rounded_list(pose.translation, kLengthDigits);
  for (const double number : q) json.push_back(rounded(number, kAngleDigits));
  return json;
}

/// Numbers of two or four bytes, little-endian, as base64.
template <class T>
[[nodiscard]] std::string base64_of(const std::vector<T>& numbers) {
  static_assert(sizeof(T) == 2 || sizeof(T) == 4,
                "base64_of() writes float, uint32_t and uint16_t");
  using Word = std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint32_t>;
  std::string bytes;
  bytes.reserve(sizeof(T) * numbers.size());
  for (const T number : numbers) {
    const std::uint32_t word = std::bit_cast<Word>(number);
    for (unsigned byte = 0; byte < sizeof(T); ++byte) {
      bytes += static_cast<char>((word >> (8 * byte)) & 255U);
    }
  }
  return base64(bytes);
}

}  // namespace kinecal::detail
