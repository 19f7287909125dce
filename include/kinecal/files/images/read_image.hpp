// Reads PNG, JPEG, BMP and TIFF images; all but BMP with libpng, libjpeg and libtiff if found at build time.
//
// The content identifies the format, not the name.  Damaged files are errors, even if they only end
// early.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/capture/image.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Largest image to read, pixels.
inline constexpr int kMostPixels = 100'000'000;

/// Reads an image as brightness; of 16 bits, the upper 8.  PNG of any kind, JPEG, BMP of 8, 24 or 32 bits
/// without compression, the first page of a TIFF of integers.
/// @throws InputError  "file: ..." if it is damaged, has more than kMostPixels, has another format,
///                     or this build lacks the library
[[nodiscard]] GrayImage read_image(const std::string& path);

/// The same from bytes.
/// @param name  of the image in messages
[[nodiscard]] GrayImage decode_image(std::string_view bytes, const std::string& name);

/// Reads a grey PNG of 16 bits with depths in millimetres, 0 where nothing was measured.
/// @return  metres
/// @throws InputError  like read_image(), and if it is not such a PNG
[[nodiscard]] DepthImage read_depth(const std::string& path);

/// The same from bytes.
/// @param name  of the image in messages
[[nodiscard]] DepthImage decode_depth(std::string_view bytes, const std::string& name);

}  // namespace kinecal
