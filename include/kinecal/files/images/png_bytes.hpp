// Encodes grey images as the bytes of PNG files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// A PNG file with 8 bits per pixel.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const GrayImage& image);

/// A PNG file with 16 bits per pixel, such as a depth image in millimetres.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const Image<std::uint16_t>& image);

}  // namespace kinecal::detail
