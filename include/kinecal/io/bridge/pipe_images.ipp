// Images and camera settings that a program sends over a pipe (pipe_robot.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/io/bridge/json_value.hpp"
#include "kinecal/io/printable.hpp"

#ifdef KINECAL_HAVE_PNG
#include <png.h>
#endif

namespace kinecal::detail {

/// Source: RFC 4648; line ends and padding may be left out.
/// @throws JsonError  if a character is not of base64
[[nodiscard]] inline std::string from_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=' || c == '\n' || c == '\r') continue;
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) throw JsonError("the base64 has a character that is none");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xff));
  }
  return bytes;
}

/// The bytes of a file name or of {"base64": "..."}.
/// @throws JsonError  naming a file that cannot be read
[[nodiscard]] inline std::string image_bytes(const JsonValue& image) {
  if (!image.is_text()) return from_base64(image.text("base64"));
  const std::string name = image.as_text();
  std::ifstream file(name, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file && bytes.empty()) throw JsonError("'" + printable(name) + "' cannot be read");
  return bytes;
}

/// A PNG as one number a pixel: 8 bits of brightness, or 16 bits as they are in the file.
/// @throws std::runtime_error  if it is not a PNG, or not of so many bits
template <class P>
[[nodiscard]] Image<P> read_png(const std::string& bytes) {
#ifdef KINECAL_HAVE_PNG
  constexpr bool kDepth = sizeof(P) == 2;
  constexpr std::uint64_t kMostPixels = 100'000'000;
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto fail = [&png](const std::string& why) {
    png_image_free(&png);
    throw std::runtime_error(why);
  };
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    fail(std::string("an image is not a PNG: ") + png.message);
  }
  if (kDepth && png.format != PNG_FORMAT_LINEAR_Y) {
    fail("a depth image is not a gray PNG of 16 bits, in millimetres");
  }
  if (std::uint64_t{png.width} * png.height > kMostPixels) fail("an image has over 100 megapixels");
  png.format = kDepth ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  Image<P> image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr) == 0) {
    fail(std::string("a PNG is damaged: ") + png.message);
  }
  return image;
#else
  (void)bytes;
  throw std::runtime_error(
      "kinecal was built without libpng; install libpng-dev and build it again");
#endif
}

[[nodiscard]] inline GrayImage pipe_image(const JsonValue& image) {
  return read_png<std::uint8_t>(image_bytes(image));
}

/// Metres, from millimetres; 0 was not measured.
[[nodiscard]] inline DepthImage pipe_depth(const JsonValue& image) {
  const auto millimetres = read_png<std::uint16_t>(image_bytes(image));
  DepthImage depth(millimetres.width, millimetres.height, no_point().z());
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    constexpr float kMillimetre = 1e-3F;
    const std::uint16_t z = millimetres.pixels[i];
    if (z > 0) depth.pixels[i] = static_cast<float>(z) * kMillimetre;
  }
  return depth;
}

template <std::size_t N>
void copy_numbers(const JsonValue& json, const std::string& field, std::array<double, N>& to) {
  const std::vector<double> numbers = json.numbers(field);
  if (numbers.size() != N) {
    throw JsonError("field '" + field + "' has " + std::to_string(numbers.size()) +
                    " numbers; expected " + std::to_string(N));
  }
  std::copy(numbers.begin(), numbers.end(), to.begin());
}

/// P is K if it is left out.
[[nodiscard]] inline CameraInfo pipe_camera(const JsonValue& json) {
  CameraInfo camera;
  camera.width = static_cast<int>(json.id("width"));
  camera.height = static_cast<int>(json.id("height"));
  camera.distortion_model = json.text_or("distortion_model", "plumb_bob");
  camera.d = json.find("d") ? json.numbers("d") : std::vector<double>(5, 0.0);
  camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (json.find("r")) copy_numbers(json, "r", camera.r);
  if (json.find("k")) copy_numbers(json, "k", camera.k);
  if (json.find("p")) {
    copy_numbers(json, "p", camera.p);
    return camera;
  }
  copy_numbers(json, "k", camera.k);  // one of both must be there
  const auto& k = camera.k;
  camera.p = {k[0], k[1], k[2], 0, k[3], k[4], k[5], 0, k[6], k[7], k[8], 0};
  return camera;
}

}  // namespace kinecal::detail
