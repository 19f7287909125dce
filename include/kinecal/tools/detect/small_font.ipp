// Letters of 5 x 7 pixels, for writing into pictures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <string_view>

namespace kinecal::detail {

/// A letter: five columns from the left, the lowest bit on top.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 5> columns;
};

inline constexpr std::array kGlyphs = {Glyph{' ', {0, 0, 0, 0, 0}},
                                       Glyph{'0', {0x3e, 0x51, 0x49, 0x45, 0x3e}},
                                       Glyph{'1', {0x00, 0x42, 0x7f, 0x40, 0x00}},
                                       Glyph{'2', {0x42, 0x61, 0x51, 0x49, 0x46}},
                                       Glyph{'3', {0x22, 0x41, 0x49, 0x49, 0x36}},
                                       Glyph{'4', {0x18, 0x14, 0x12, 0x7f, 0x10}},
                                       Glyph{'5', {0x27, 0x45, 0x45, 0x45, 0x39}},
                                       Glyph{'6', {0x3e, 0x49, 0x49, 0x49, 0x32}},
                                       Glyph{'7', {0x01, 0x71, 0x09, 0x05, 0x03}},
                                       Glyph{'8', {0x36, 0x49, 0x49, 0x49, 0x36}},
                                       Glyph{'9', {0x26, 0x49, 0x49, 0x49, 0x3e}},
                                       Glyph{'A', {0x7e, 0x09, 0x09, 0x09, 0x7e}},
                                       Glyph{'B', {0x7f, 0x49, 0x49, 0x49, 0x36}},
                                       Glyph{'C', {0x3e, 0x41, 0x41, 0x41, 0x22}},
                                       Glyph{'D', {0x7f, 0x41, 0x41, 0x41, 0x3e}},
                                       Glyph{'E', {0x7f, 0x49, 0x49, 0x49, 0x41}},
                                       Glyph{'F', {0x7f, 0x09, 0x09, 0x09, 0x01}},
                                       Glyph{'G', {0x3e, 0x41, 0x41, 0x49, 0x7a}},
                                       Glyph{'H', {0x7f, 0x08, 0x08, 0x08, 0x7f}},
                                       Glyph{'I', {0x00, 0x41, 0x7f, 0x41, 0x00}},
                                       Glyph{'J', {0x20, 0x40, 0x40, 0x40, 0x3f}},
                                       Glyph{'K', {0x7f, 0x08, 0x14, 0x22, 0x41}},
                                       Glyph{'L', {0x7f, 0x40, 0x40, 0x40, 0x40}},
                                       Glyph{'M', {0x7f, 0x02, 0x0c, 0x02, 0x7f}},
                                       Glyph{'N', {0x7f, 0x04, 0x08, 0x10, 0x7f}},
                                       Glyph{'O', {0x3e, 0x41, 0x41, 0x41, 0x3e}},
                                       Glyph{'P', {0x7f, 0x09, 0x09, 0x09, 0x06}},
                                       Glyph{'Q', {0x3e, 0x41, 0x51, 0x21, 0x5e}},
                                       Glyph{'R', {0x7f, 0x09, 0x19, 0x29, 0x46}},
                                       Glyph{'S', {0x26, 0x49, 0x49, 0x49, 0x32}},
                                       Glyph{'T', {0x01, 0x01, 0x7f, 0x01, 0x01}},
                                       Glyph{'U', {0x3f, 0x40, 0x40, 0x40, 0x3f}},
                                       Glyph{'V', {0x1f, 0x20, 0x40, 0x20, 0x1f}},
                                       Glyph{'W', {0x7f, 0x20, 0x18, 0x20, 0x7f}},
                                       Glyph{'X', {0x63, 0x14, 0x08, 0x14, 0x63}},
                                       Glyph{'Y', {0x03, 0x04, 0x78, 0x04, 0x03}},
                                       Glyph{'Z', {0x61, 0x51, 0x49, 0x45, 0x43}},
                                       Glyph{'.', {0x00, 0x60, 0x60, 0x00, 0x00}},
                                       Glyph{',', {0x00, 0x50, 0x30, 0x00, 0x00}},
                                       Glyph{':', {0x00, 0x36, 0x36, 0x00, 0x00}},
                                       Glyph{';', {0x00, 0x56, 0x36, 0x00, 0x00}},
                                       Glyph{'-', {0x08, 0x08, 0x08, 0x08, 0x08}},
                                       Glyph{'_', {0x40, 0x40, 0x40, 0x40, 0x40}},
                                       Glyph{'\'', {0x00, 0x00, 0x03, 0x00, 0x00}},
                                       Glyph{'/', {0x60, 0x10, 0x08, 0x04, 0x03}},
                                       Glyph{'(', {0x00, 0x1c, 0x22, 0x41, 0x00}},
                                       Glyph{')', {0x00, 0x41, 0x22, 0x1c, 0x00}},
                                       Glyph{'%', {0x23, 0x13, 0x08, 0x64, 0x62}},
                                       Glyph{'+', {0x08, 0x08, 0x3e, 0x08, 0x08}},
                                       Glyph{'?', {0x02, 0x01, 0x51, 0x09, 0x06}}};

inline constexpr int kGlyphWidth = 6, kGlyphHeight = 9;  ///< with space between letters and lines

/// Calls pixel(x, y) for each pixel of a text; unknown letters become question marks.
template <class Pixel>
void for_pixels_of(std::string_view text, Pixel&& pixel) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto upper = static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
    auto glyph = std::find_if(kGlyphs.begin(), kGlyphs.end(),
                              [&](const Glyph& g) { return g.letter == upper; });
    if (glyph == kGlyphs.end()) --glyph;
    for (int x = 0; x < 5; ++x) {
      for (int y = 0; y < 7; ++y) {
        const bool set = (glyph->columns[static_cast<std::size_t>(x)] >> y & 1) != 0;
        if (set) pixel(static_cast<int>(i) * kGlyphWidth + x, y);
      }
    }
  }
}

}  // namespace kinecal::detail
