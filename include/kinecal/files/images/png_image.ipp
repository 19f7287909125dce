// Decodes PNG images with libpng's simplified interface, which has no jumps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "kinecal/files/images/image_size.ipp"
#include "kinecal/files/images/read_image.hpp"

#ifdef KINECAL_HAVE_PNG
#include <png.h>
#endif

namespace kinecal::detail {

#ifdef KINECAL_HAVE_PNG
/// An image held by libpng until it is freed.
struct PngImage {
  png_image png{};
  PngImage() { png.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&png); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

/// Opens a PNG.
inline void begin_png(PngImage& image, std::string_view bytes, const std::string& name) {
  if (png_image_begin_read_from_memory(&image.png, bytes.data(), bytes.size()) == 0) {
    throw InputError(name + ": the PNG is damaged: " + image.png.message);
  }
  check_image_size(image.png.width, image.png.height, name);
}

/// Reads the pixels in one of libpng's forms.
template <class P>
[[nodiscard]] Image<P> finish_png(PngImage& image, png_uint_32 form, const std::string& name) {
  image.png.format = form;
  Image<P> pixels(static_cast<int>(image.png.width), static_cast<int>(image.png.height));
  if (png_image_finish_read(&image.png, nullptr, pixels.pixels.data(), 0, nullptr) == 0) {
    throw InputError(name + ": the PNG is damaged: " + image.png.message);
  }
  return pixels;
}

/// 16 bits as stored in the file; libpng would treat them as linear and convert them to 8.
[[nodiscard]] inline Image<std::uint16_t> read_png16(PngImage& image, const std::string& name) {
  return finish_png<std::uint16_t>(image, PNG_FORMAT_LINEAR_Y, name);
}

[[nodiscard]] inline GrayImage png_brightness(std::string_view bytes, const std::string& name) {
  PngImage image;
  begin_png(image, bytes, name);
  if ((image.png.format & PNG_FORMAT_FLAG_LINEAR) == 0) {
    return finish_png<std::uint8_t>(image, PNG_FORMAT_GRAY, name);
  }
  const Image<std::uint16_t> fine = read_png16(image, name);
  GrayImage gray(fine.width, fine.height);
  for (std::size_t i = 0; i < fine.pixels.size(); ++i) {
    gray.pixels[i] = static_cast<std::uint8_t>(fine.pixels[i] >> 8);
  }
  return gray;
}

[[nodiscard]] inline Image<std::uint16_t> png_depth(std::string_view bytes,
                                                    const std::string& name) {
  PngImage image;
  begin_png(image, bytes, name);
  if (image.png.format != PNG_FORMAT_LINEAR_Y) {
    throw InputError(name + ": is not a grey PNG of 16 bits, as depth in millimetres is");
  }
  return read_png16(image, name);
}
#else
[[nodiscard]] inline GrayImage png_brightness(std::string_view, const std::string& name) {
  throw InputError(name + ": PNG needs libpng; install libpng-dev and build kinecal again");
}

[[nodiscard]] inline Image<std::uint16_t> png_depth(std::string_view, const std::string& name) {
  throw InputError(name + ": PNG needs libpng; install libpng-dev and build kinecal again");
}
#endif

}  // namespace kinecal::detail
