// Decodes BMP images without compression.
//
// A file is a header of 14 bytes, a second one that begins with its own size, a palette for 8 bits, and rows
// of pixels: from the bottom up, or from the top down if the height is negative, each of whole 4 bytes.
// Source: Microsoft, Windows GDI, BITMAPFILEHEADER and BITMAPV5HEADER.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "kinecal/files/images/image_size.ipp"
#include "kinecal/files/images/read_image.hpp"

namespace kinecal::detail {

/// Reads numbers of a BMP, and none outside of the file.
class BmpBytes {
 public:
  BmpBytes(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  /// A number of so many bytes, the lowest first.
  /// @throws InputError  if the file ends before
  [[nodiscard]] std::uint32_t number(std::uint64_t at, unsigned count) const {
    need(at, count);
    std::uint32_t value = 0;
    for (unsigned i = count; i-- > 0;) value = (value << 8U) | byte(at + i);
    return value;
  }
  /// @throws InputError  if the file ends before
  void need(std::uint64_t at, std::uint64_t count) const {
    if (at > bytes_.size() || count > bytes_.size() - at) fail("it ends early");
  }
  /// A byte that is there.
  [[nodiscard]] unsigned byte(std::uint64_t at) const {
    return static_cast<unsigned char>(bytes_[at]);
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(name_ + ": the BMP is damaged: " + why);
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(name_ + ": is a BMP " + what +
                     ", which is not read; store it with 8, 24 or 32 bits, without compression");
  }

 private:
  std::string_view bytes_;
  const std::string& name_;
};

/// What the headers of a BMP say.
struct BmpLayout {
  std::uint32_t width = 0, height = 0, bits = 0;
  bool top_down = false;
  std::uint64_t pixels = 0, row = 0;  ///< where they begin; bytes from one to the next
  std::array<std::uint8_t, 256> palette = {};
  std::uint32_t colours = 0;  ///< of the palette
};

inline constexpr std::uint64_t kBmpFirstHeader = 14;

/// @throws InputError  if 32 bits are not blue, green, red and a byte without effect
inline void check_bmp_masks(const BmpBytes& bytes) {
  constexpr std::uint64_t kMasks = kBmpFirstHeader + 40;
  const bool is_usual = bytes.number(kMasks, 4) == 0xff0000 &&
                        bytes.number(kMasks + 4, 4) == 0xff00 &&
                        bytes.number(kMasks + 8, 4) == 0xff;
  if (!is_usual) bytes.refuse("with colours in an unusual order");
}

/// Reads the brightness of the colours of a palette.
inline void read_bmp_palette(const BmpBytes& bytes, std::uint32_t header, BmpLayout& layout) {
  const std::uint32_t used = bytes.number(kBmpFirstHeader + 32, 4);
  layout.colours = used == 0 ? 256 : used;
  if (layout.colours > 256) bytes.fail("its palette has " + std::to_string(used) + " colours");
  for (std::uint32_t i = 0; i < layout.colours; ++i) {
    const std::uint32_t colour = bytes.number(kBmpFirstHeader + header + 4 * std::uint64_t{i}, 4);
    layout.palette[i] = brightness_of(colour >> 16U & 0xffU, colour >> 8U & 0xffU, colour & 0xffU);
  }
}

[[nodiscard]] inline BmpLayout read_bmp_layout(const BmpBytes& bytes, const std::string& name) {
  constexpr std::uint32_t kLeastHeader = 40, kPlain = 0, kMasked = 3, kLowest = 0x80000000U;
  const std::uint32_t header = bytes.number(kBmpFirstHeader, 4);
  if (header < kLeastHeader) bytes.refuse("of a kind before Windows 3");
  BmpLayout layout;
  layout.pixels = bytes.number(10, 4);
  layout.width = bytes.number(kBmpFirstHeader + 4, 4);
  layout.height = bytes.number(kBmpFirstHeader + 8, 4);
  layout.bits = bytes.number(kBmpFirstHeader + 14, 2);
  const std::uint32_t compression = bytes.number(kBmpFirstHeader + 16, 4);
  layout.top_down = layout.height >= kLowest;
  if (layout.top_down) layout.height = ~layout.height + 1U;
  if (layout.width >= kLowest) bytes.fail("its width is negative");
  check_image_size(layout.width, layout.height, name);
  if (layout.bits != 8 && layout.bits != 24 && layout.bits != 32) {
    bytes.refuse("of " + std::to_string(layout.bits) + " bits");
  }
  const bool is_masked = compression == kMasked && layout.bits == 32;
  if (compression != kPlain && !is_masked) bytes.refuse("with compression");
  if (is_masked) check_bmp_masks(bytes);
  if (layout.bits == 8) read_bmp_palette(bytes, header, layout);
  layout.row = (std::uint64_t{layout.width} * layout.bits + 31) / 32 * 4;
  if (layout.pixels < kBmpFirstHeader + header) bytes.fail("its pixels are in its header");
  bytes.need(layout.pixels, layout.row * layout.height);
  return layout;
}

[[nodiscard]] inline GrayImage bmp_brightness(std::string_view file, const std::string& name) {
  const BmpBytes bytes(file, name);
  const BmpLayout layout = read_bmp_layout(bytes, name);
  GrayImage image(static_cast<int>(layout.width), static_cast<int>(layout.height));
  const unsigned step = layout.bits / 8;
  for (std::uint32_t v = 0; v < layout.height; ++v) {
    const std::uint64_t row =
        layout.pixels + layout.row * (layout.top_down ? v : layout.height - 1 - v);
    for (std::uint32_t u = 0; u < layout.width; ++u) {
      const std::uint64_t at = row + std::uint64_t{u} * step;
      std::uint8_t& pixel = image(static_cast<int>(u), static_cast<int>(v));
      if (layout.bits == 8) {
        const unsigned colour = bytes.byte(at);
        if (colour >= layout.colours) bytes.fail("a pixel has a colour that its palette lacks");
        pixel = layout.palette[colour];
      } else {
        pixel = brightness_of(bytes.byte(at + 2), bytes.byte(at + 1), bytes.byte(at));
      }
    }
  }
  return image;
}

}  // namespace kinecal::detail
