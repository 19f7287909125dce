// Encodes images as the bytes of PNG files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// A colour, 0 to 255 each.
struct Rgb {
  std::uint8_t red = 0, green = 0, blue = 0;
};

/// A PNG file with 8 bits per pixel.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const GrayImage& image);

/// A PNG file with 16 bits per pixel, such as a depth image in millimetres.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const Image<std::uint16_t>& image);

/// A PNG file in colour.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const Image<Rgb>& image);

}  // namespace kinecal::detail
