// The limit on the size of images, and the brightness of colours, for read_image.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kinecal/files/images/read_image.hpp"

namespace kinecal::detail {

/// @throws InputError  if an image is too large or has no pixels
inline void check_image_size(std::uint64_t width, std::uint64_t height, const std::string& name) {
  if (width > 0 && height > 0 && width <= kMostPixels && height <= kMostPixels / width) return;
  throw InputError(name + ": has " + std::to_string(width) + "x" + std::to_string(height) +
                   " pixels; at most " + std::to_string(kMostPixels / 1'000'000) +
                   " megapixels are read");
}

/// Brightness of a colour, 0 to 255.  Source: ITU-R BT.601, as in JPEG.
[[nodiscard]] inline std::uint8_t brightness_of(unsigned red, unsigned green, unsigned blue) {
  return static_cast<std::uint8_t>((299 * red + 587 * green + 114 * blue + 500) / 1000);
}

}  // namespace kinecal::detail
