// Grey images as the bytes of PNG files, to write them together with other files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kinecal/capture/image.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// A PNG file with 8 bits for each pixel.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const GrayImage& image);

/// A PNG file with 16 bits for each pixel, such as a depth image in millimetres.
/// @throws std::invalid_argument  if the image is empty
[[nodiscard]] std::string png_bytes(const Image<std::uint16_t>& image);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/io/simulation/png_bytes.ipp"
#endif
