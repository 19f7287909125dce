// Definitions of view_message.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/view_message.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/messages/cloud_message.ipp"
#include "kinecal/files/messages/depth_message.ipp"
#include "kinecal/files/messages/message_rows.ipp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// Pixels of an encoding: their values, and which of these are red, green and blue; all the same
/// for gray, or for brightness beside two colours.
struct PixelForm {
  std::string_view name;
  std::size_t values, red, green, blue;
  std::size_t bytes = 1;  ///< of a value
};

inline constexpr std::array kPixelForms = {
    PixelForm{"mono8", 1, 0, 0, 0},       PixelForm{"8UC1", 1, 0, 0, 0},
    PixelForm{"rgb8", 3, 0, 1, 2},        PixelForm{"8UC3", 3, 2, 1, 0},
    PixelForm{"bgr8", 3, 2, 1, 0},        PixelForm{"rgba8", 4, 0, 1, 2},
    PixelForm{"bgra8", 4, 2, 1, 0},       PixelForm{"8UC4", 4, 2, 1, 0},
    PixelForm{"yuv422", 2, 1, 1, 1},      PixelForm{"uyvy", 2, 1, 1, 1},
    PixelForm{"yuv422_yuy2", 2, 0, 0, 0}, PixelForm{"yuyv", 2, 0, 0, 0},
    PixelForm{"nv12", 1, 0, 0, 0},        PixelForm{"nv21", 1, 0, 0, 0},
    PixelForm{"nv24", 1, 0, 0, 0},        PixelForm{"mono16", 1, 0, 0, 0, 2},
    PixelForm{"16UC1", 1, 0, 0, 0, 2},    PixelForm{"rgb16", 3, 0, 1, 2, 2},
    PixelForm{"bgr16", 3, 2, 1, 0, 2},    PixelForm{"16UC3", 3, 2, 1, 0, 2},
    PixelForm{"rgba16", 4, 0, 1, 2, 2},   PixelForm{"bgra16", 4, 2, 1, 0, 2},
    PixelForm{"16UC4", 4, 2, 1, 0, 2}};

inline constexpr std::array<std::string_view, 4> kBayer = {"bayer_rggb", "bayer_bggr", "bayer_gbrg",
                                                           "bayer_grbg"};

/// @throws std::runtime_error  if the encoding is not one of gray or colour images
[[nodiscard]] inline PixelForm pixel_form(std::string_view encoding) {
  for (const std::string_view bayer : kBayer) {
    if (!encoding.starts_with(bayer)) continue;
    const std::string_view bits = encoding.substr(bayer.size());
    if (bits == "8") return {bayer, 1, 0, 0, 0, 1};
    if (bits == "16") return {bayer, 1, 0, 0, 0, 2};
  }
  for (const PixelForm& form : kPixelForms) {
    if (form.name == encoding) return form;
  }
  throw std::runtime_error("images of encoding '" + printable(encoding) +
                           "' are not supported; expected gray, colour, Bayer or YUV 4:2:2 of 8 or "
                           "16 bits");
}

/// Brightness of all pixels, 0 to 255, or to 65535 for 16 bits.
[[nodiscard]] inline Image<std::uint16_t> values_of(const MessageRows& rows,
                                                    const PixelForm& form) {
  Image<std::uint16_t> image(rows.width, rows.height);
  const std::size_t low = form.bytes == 2 && rows.order == std::endian::big ? 1 : 0;
  const auto value = [&](const std::byte* pixel, std::size_t i) {
    const std::byte* at = pixel + i * form.bytes;
    if (form.bytes == 1) return std::to_integer<unsigned>(*at);
    return std::to_integer<unsigned>(at[low]) | std::to_integer<unsigned>(at[1 - low]) << 8U;
  };
  for (int v = 0; v < rows.height; ++v) {
    const std::byte* pixel = rows.data.data() + static_cast<std::size_t>(v) * rows.step;
    for (int u = 0; u < rows.width; ++u, pixel += form.values * form.bytes) {
      const unsigned red = value(pixel, form.red);
      image(u, v) = static_cast<std::uint16_t>(
          form.red == form.blue
              ? red
              : brightness(red, value(pixel, form.green), value(pixel, form.blue)));
    }
  }
  return image;
}

/// Weights 1 2 1 along rows and columns: on a mosaic, red and blue have a quarter and green a half
/// of every pixel, whatever its colour.
[[nodiscard]] inline Image<std::uint16_t> smoothed(const Image<std::uint16_t>& mosaic) {
  Image<std::uint16_t> smooth(mosaic.width, mosaic.height);
  const auto mirrored = [](int i, int size) {  // at the border; keeps the colour
    return size < 2 ? 0 : i < 0 ? 1 : i >= size ? size - 2 : i;
  };
  for (int v = 0; v < mosaic.height; ++v) {
    const std::array<int, 3> rows = {mirrored(v - 1, mosaic.height), v,
                                     mirrored(v + 1, mosaic.height)};
    for (int u = 0; u < mosaic.width; ++u) {
      const int left = mirrored(u - 1, mosaic.width), right = mirrored(u + 1, mosaic.width);
      unsigned sum = 8;  // half of the divisor
      for (int k = 0; k < 3; ++k) {
        const int row = rows[static_cast<std::size_t>(k)];
        const unsigned line = mosaic(left, row) + 2U * mosaic(u, row) + mosaic(right, row);
        sum += k == 1 ? 2 * line : line;
      }
      smooth(u, v) = static_cast<std::uint16_t>(sum / 16);
    }
  }
  return smooth;
}

/// Number of used bits beyond 8 in 16-bit values: cameras of 10, 12 and 14 bits leave the upper
/// ones unused.
[[nodiscard]] inline int spare_bits(const Image<std::uint16_t>& image) {
  const auto most = *std::max_element(image.pixels.begin(), image.pixels.end());
  int bits = 2;
  while (bits < 8 && most >> (8 + bits) != 0) bits += 2;
  return bits;
}

GrayImage gray_image(const MessageFields& message) {
  if (const auto file = compressed(message)) {
    const std::string_view format = text_at(message, "format");
    const bool is_video = format.find("264") != std::string_view::npos ||
                          format.find("265") != std::string_view::npos ||
                          format.find("hevc") != std::string_view::npos;
    if (is_video) {
      throw std::runtime_error("its images are video, '" + printable(format) +
                               "', which is not read; record image_raw or JPEG instead");
    }
    return decode_image(*file, "the image");
  }
  const std::string_view encoding = text_at(message, "encoding");
  const PixelForm form = pixel_form(encoding);
  Image<std::uint16_t> values = values_of(rows_of(message, "step", form.values * form.bytes), form);
  if (encoding.starts_with("bayer_")) values = smoothed(values);
  const int shift = form.bytes == 1 ? 0 : spare_bits(values);
  GrayImage image(values.width, values.height);
  std::transform(values.pixels.begin(), values.pixels.end(), image.pixels.begin(),
                 [shift](std::uint16_t x) { return static_cast<std::uint8_t>(x >> shift); });
  return image;
}

}  // namespace kinecal::detail
