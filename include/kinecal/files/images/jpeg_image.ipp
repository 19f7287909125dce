// Decodes JPEG images with libjpeg.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/files/images/image_size.ipp"
#include "kinecal/files/images/read_image.hpp"

#ifdef KINECAL_HAVE_JPEG
#include <csetjmp>
#include <cstdio>
// libjpeg's header needs FILE declared before it.
#include <jerror.h>
#include <jpeglib.h>
#endif

namespace kinecal::detail {

#ifdef KINECAL_HAVE_JPEG
/// Replaces libjpeg's error handler, which exits the program.
struct JpegErrors {
  jpeg_error_mgr handler{};  ///< first, so that libjpeg's pointer to it also points to this
  std::jmp_buf back{};
  char reason[JMSG_LENGTH_MAX] = {};
};

[[noreturn]] inline void jpeg_failed(j_common_ptr jpeg) {
  auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);
  jpeg->err->format_message(jpeg, errors->reason);
  std::longjmp(errors->back, 1);
}

/// Turns libjpeg's warnings into errors: an image that ends early or is damaged.
inline void jpeg_warned(j_common_ptr jpeg, int level) {
  const int code = jpeg->err->msg_code;
  if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_JFIF_MAJOR) jpeg_failed(jpeg);
}

/// A decoder that always frees its memory.
struct JpegDecoder {
  jpeg_decompress_struct jpeg{};
  JpegErrors errors;
  JpegDecoder() {
    jpeg.err = jpeg_std_error(&errors.handler);
    errors.handler.error_exit = jpeg_failed;
    errors.handler.emit_message = jpeg_warned;
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;
};

/// Reads the header.  Constructs no objects where libjpeg may jump.
/// @return  false, with the reason in the decoder, if it is damaged
[[nodiscard]] inline bool begin_jpeg(JpegDecoder& decoder, std::string_view bytes) {
  if (setjmp(decoder.errors.back) != 0) return false;
  jpeg_create_decompress(&decoder.jpeg);
  jpeg_mem_src(&decoder.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&decoder.jpeg, TRUE);
  return true;
}

/// Reads the pixels.
[[nodiscard]] inline bool finish_jpeg(JpegDecoder& decoder, GrayImage& image) {
  if (setjmp(decoder.errors.back) != 0) return false;
  decoder.jpeg.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&decoder.jpeg);
  while (decoder.jpeg.output_scanline < decoder.jpeg.output_height) {
    JSAMPROW row = &image(0, static_cast<int>(decoder.jpeg.output_scanline));
    jpeg_read_scanlines(&decoder.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&decoder.jpeg);
  return true;
}

[[nodiscard]] inline GrayImage jpeg_brightness(std::string_view bytes, const std::string& name) {
  JpegDecoder decoder;
  const auto fail = [&] {
    throw InputError(name + ": the JPEG is damaged: " + decoder.errors.reason);
  };
  if (!begin_jpeg(decoder, bytes)) fail();
  check_image_size(decoder.jpeg.image_width, decoder.jpeg.image_height, name);
  GrayImage image(static_cast<int>(decoder.jpeg.image_width),
                  static_cast<int>(decoder.jpeg.image_height));
  if (!finish_jpeg(decoder, image)) fail();
  return image;
}
#else
[[nodiscard]] inline GrayImage jpeg_brightness(std::string_view, const std::string& name) {
  throw InputError(name + ": JPEG needs libjpeg; install libjpeg-dev and build kinecal again");
}
#endif

}  // namespace kinecal::detail
