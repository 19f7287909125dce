// Definitions of read_image.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/images/read_image.hpp"

#include <cstdint>

#include "kinecal/files/images/bmp_image.ipp"
#include "kinecal/files/images/jpeg_image.ipp"
#include "kinecal/files/images/png_image.ipp"
#include "kinecal/files/images/tiff_image.ipp"
#include "kinecal/files/text_file.hpp"

namespace kinecal {

GrayImage decode_image(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("\x89PNG")) return detail::png_brightness(bytes, name);
  if (bytes.starts_with("\xff\xd8\xff")) return detail::jpeg_brightness(bytes, name);
  if (bytes.starts_with("BM")) return detail::bmp_brightness(bytes, name);
  if (detail::is_tiff(bytes)) return detail::tiff_brightness(bytes, name);
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) {
    throw InputError(name +
                     ": is WebP, which is not read; convert it to PNG (dwebp), or record PNG or "
                     "JPEG");
  }
  throw InputError(name + ": is not a PNG, JPEG, BMP or TIFF; convert the image to one of them");
}

DepthImage decode_depth(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("\x89PNG")) {
    throw InputError(name + ": is not a PNG; depth is a grey PNG of 16 bits, in millimetres");
  }
  const Image<std::uint16_t> millimetres = detail::png_depth(bytes, name);
  DepthImage depth(millimetres.width, millimetres.height, no_point().z());
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    constexpr float kMillimetre = 1e-3F;
    const std::uint16_t z = millimetres.pixels[i];
    if (z > 0) depth.pixels[i] = static_cast<float>(z) * kMillimetre;
  }
  return depth;
}

GrayImage read_image(const std::string& path) {
  return decode_image(detail::read_text_file(path), path);
}

DepthImage read_depth(const std::string& path) {
  return decode_depth(detail::read_text_file(path), path);
}

}  // namespace kinecal
