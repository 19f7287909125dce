// The pieces of a scene's JSON: strings that are safe in HTML, short numbers, base64.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/report/checksum.hpp"
#include "kinecal/report/json.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/report/scene_text.hpp"

namespace kinecal::detail {

inline constexpr int kLengthDigits = 5;  ///< 0.01 mm
inline constexpr int kAngleDigits = 6;   ///< 0.06 mdeg

/// Length of the UTF-8 sequence at the beginning of a text; 0 if there is none.
[[nodiscard]] inline std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t size = first < 0x80   ? 1
                           : first < 0xC2 ? 0
                           : first < 0xE0 ? 2
                           : first < 0xF0 ? 3
                           : first < 0xF5 ? 4
                                          : 0;
  if (size == 0 || size > text.size()) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  if (size == 1) return 1;
  const unsigned second = byte(1);  // not too long a form, no surrogates, not beyond U+10FFFF
  const bool wrong = (first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
                     (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90);
  return wrong ? 0 : size;
}

KINECAL_INLINE std::string html_json_string(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    clean += length == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  std::string json;
  for (const std::string plain = json_string(clean); const char c : plain) {
    if (c == '<' || c == '>' || c == '&' || c == '\x7f') {
      json += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      json += c;
    }
  }
  for (const auto& [bytes, escape] :
       {std::pair("\xE2\x80\xA8", "\\u2028"), std::pair("\xE2\x80\xA9", "\\u2029")}) {
    for (std::size_t at = json.find(bytes); at != std::string::npos; at = json.find(bytes, at)) {
      json.replace(at, 3, escape);
    }
  }
  return json;
}

KINECAL_INLINE std::string short_number(double value, int digits) {
  if (!std::isfinite(value)) return "0";
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

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
