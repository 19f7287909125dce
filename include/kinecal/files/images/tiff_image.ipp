// Decodes TIFF images with libtiff.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/images/image_size.ipp"
#include "kinecal/files/images/read_image.hpp"

#ifdef KINECAL_HAVE_TIFF
#include <tiffio.h>
#endif

namespace kinecal::detail {

/// True for the first bytes of a TIFF of either byte order, or of a BigTIFF.
[[nodiscard]] inline bool is_tiff(std::string_view bytes) {
  using namespace std::string_view_literals;
  return bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv) ||
         bytes.starts_with("II+\0"sv) || bytes.starts_with("MM\0+"sv);
}

#ifdef KINECAL_HAVE_TIFF
/// No photograph is compressed to less: of a file that claims more pixels, few bytes would take much memory.
inline constexpr std::uint64_t kMostTiffPixelsOfAByte = 2000;

/// Bytes in memory, as libtiff reads them, and its first complaint.
struct TiffBytes {
  std::string_view bytes;
  std::size_t at = 0;
  std::string complaint = {};
};

/// Reads the next bytes.
inline tmsize_t read_tiff_bytes(thandle_t handle, void* to, tmsize_t count) {
  auto& from = *static_cast<TiffBytes*>(handle);
  const std::size_t left = from.bytes.size() - std::min(from.at, from.bytes.size());
  const std::size_t now = std::min(left, static_cast<std::size_t>(std::max<tmsize_t>(0, count)));
  if (now > 0) std::memcpy(to, from.bytes.data() + from.at, now);
  from.at += now;
  return static_cast<tmsize_t>(now);
}

/// Moves to a place; one beyond the end has no bytes.
inline toff_t seek_tiff_bytes(thandle_t handle, toff_t offset, int whence) {
  auto& from = *static_cast<TiffBytes*>(handle);
  const std::size_t origin = whence == SEEK_CUR   ? from.at
                             : whence == SEEK_END ? from.bytes.size()
                                                  : 0;
  from.at = origin + static_cast<std::size_t>(offset);
  return from.at;
}

#if TIFFLIB_VERSION >= 20221213  // 4.5: handlers of one file, not of the process
/// Keeps what libtiff would print.
inline int keep_tiff_error(TIFF*, void* user, const char*, const char* form, va_list list) {
  auto& from = *static_cast<TiffBytes*>(user);
  char text[256];
  std::vsnprintf(text, sizeof text, form, list);
  if (from.complaint.empty()) from.complaint = text;
  return 1;
}
inline int ignore_tiff_warning(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}
#endif

/// Opens a TIFF; nullptr for another file.
[[nodiscard]] inline TIFF* open_tiff(TiffBytes& from) {
  const auto write = [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; };
  const auto close = [](thandle_t) { return 0; };
  const auto size = [](thandle_t handle) -> toff_t {
    return static_cast<TiffBytes*>(handle)->bytes.size();
  };
#if TIFFLIB_VERSION >= 20221213
  constexpr std::uint64_t kMostMemory = 1'000'000'000, kPixel = 8;  // bytes
  const std::uint64_t memory =
      std::min(kMostMemory, kPixel * kMostTiffPixelsOfAByte * from.bytes.size());
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, static_cast<tmsize_t>(memory));
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_tiff_error, &from);
  TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_tiff_warning, nullptr);
  TIFF* tiff = TIFFClientOpenExt("image", "rm", &from, read_tiff_bytes, write, seek_tiff_bytes,
                                 close, size, nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  return tiff;
#else
  TIFFSetErrorHandler(nullptr);
  TIFFSetWarningHandler(nullptr);
  return TIFFClientOpen("image", "rm", &from, read_tiff_bytes, write, seek_tiff_bytes, close, size,
                        nullptr, nullptr);
#endif
}

/// A TIFF that is always closed.
struct OpenTiff {
  explicit OpenTiff(TiffBytes& from) : tiff(open_tiff(from)) {}
  ~OpenTiff() {
    if (tiff != nullptr) TIFFClose(tiff);
  }
  OpenTiff(const OpenTiff&) = delete;
  OpenTiff& operator=(const OpenTiff&) = delete;
  TIFF* tiff;
};

[[nodiscard]] inline GrayImage tiff_brightness(std::string_view bytes, const std::string& name) {
  TiffBytes from{bytes};
  const OpenTiff open(from);
  const auto fail = [&](const std::string& why) {
    throw InputError(name + ": the TIFF is damaged or of a kind that is not read" +
                     (why.empty() ? "" : ": " + why));
  };
  std::uint32_t width = 0, height = 0;
  if (open.tiff == nullptr || TIFFGetField(open.tiff, TIFFTAG_IMAGEWIDTH, &width) == 0 ||
      TIFFGetField(open.tiff, TIFFTAG_IMAGELENGTH, &height) == 0) {
    fail(from.complaint);
  }
  check_image_size(width, height, name);
  if (std::uint64_t{width} * height > kMostTiffPixelsOfAByte * bytes.size()) {
    fail("it has too few bytes for its pixels");
  }
  char why[1024] = {};
  if (TIFFRGBAImageOK(open.tiff, why) == 0) fail(why);
  std::vector<std::uint32_t> colours(std::size_t{width} * height);
  constexpr int kStopOnError = 1;
  if (TIFFReadRGBAImageOriented(open.tiff, width, height, colours.data(), ORIENTATION_TOPLEFT,
                                kStopOnError) == 0) {
    fail(from.complaint);
  }
  GrayImage image(static_cast<int>(width), static_cast<int>(height));
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const std::uint32_t colour = colours[i];
    image.pixels[i] = brightness_of(TIFFGetR(colour), TIFFGetG(colour), TIFFGetB(colour));
  }
  return image;
}
#else
[[nodiscard]] inline GrayImage tiff_brightness(std::string_view, const std::string& name) {
  throw InputError(name + ": TIFF needs libtiff; install libtiff-dev and build kinecal again");
}
#endif

}  // namespace kinecal::detail
