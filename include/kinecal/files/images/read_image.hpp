// Images from PNG and JPEG files, by libpng and libjpeg where they were found.
//
// The content shows the format, not the name.  Damaged files are errors, also those that only end
// early.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/capture/image.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// Pixels of the largest image that is read.
inline constexpr int kMostPixels = 100'000'000;

/// Reads a PNG of any kind or a JPEG as brightness; of 16 bits, the upper 8.
/// @throws InputError  "file: ..." if it is damaged, has over kMostPixels, is in another format, or
///                     kinecal was built without the library for it
[[nodiscard]] GrayImage read_image(const std::string& path);

/// The same of bytes.
/// @param name  of the image in messages
[[nodiscard]] GrayImage decode_image(std::string_view bytes, const std::string& name);

/// Reads a grey PNG of 16 bits with depths in millimetres, 0 where nothing was measured.
/// @return  metres
/// @throws InputError  as read_image(), and if it is not such a PNG
[[nodiscard]] DepthImage read_depth(const std::string& path);

/// The same of bytes.
/// @param name  of the image in messages
[[nodiscard]] DepthImage decode_depth(std::string_view bytes, const std::string& name);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/images/read_image.ipp"
#endif
