// Definitions of contact_sheet.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/images/png_bytes.hpp"

namespace kinecal {

namespace detail {
namespace {

// Letters of 5 x 7 pixels, for writing into pictures.

/// A letter: five columns from the left, the lowest bit on top.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 5> columns;
};

constexpr std::array kGlyphs = {Glyph{' ', {0, 0, 0, 0, 0}},
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

constexpr int kGlyphWidth = 6, kGlyphHeight = 9;  ///< with space between letters and lines

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

// Drawing a view of a contact sheet: its picture, marks, and the grid.

constexpr Rgb kPaper{245, 245, 245}, kInk{30, 30, 30}, kFoundColour{0, 200, 60},
    kRefusedColour{215, 30, 30}, kGridColour{60, 150, 255}, kDroppedColour{255, 0, 255},
    kFirstColour{255, 140, 0};

/// A picture to draw on; ignores anything outside.
struct ContactPicture {
  Image<Rgb> picture;

  void dot(int x, int y, const Rgb& colour) {
    if (picture.contains(x, y)) picture(x, y) = colour;
  }
  void text(int x, int y, std::string_view words, const Rgb& colour) {
    for_pixels_of(words, [&](int dx, int dy) {
      for (int i = 0; i < kLetter * kLetter; ++i) {
        dot(x + kLetter * dx + i % kLetter, y + kLetter * dy + i / kLetter, colour);
      }
    });
  }
  /// The border of a rectangle, two pixels wide.
  void frame(int x, int y, int width, int height, const Rgb& colour) {
    for (int i = 0; i < width; ++i) {
      for (const int row : {0, 1, height - 2, height - 1}) dot(x + i, y + row, colour);
    }
    for (int i = 0; i < height; ++i) {
      for (const int column : {0, 1, width - 2, width - 1}) dot(x + column, y + i, colour);
    }
  }

  static constexpr int kLetter = 2;  ///< pixels of the picture for one of the font
};

/// The picture of a view at its place on the sheet; draws nothing beyond it.
struct ContactTile {
  ContactPicture& sheet;
  const Thumbnail& view;
  int x = 0, y = 0;

  void dot(double u, double v, const Rgb& colour) const {
    const double column = std::round(u), row = std::round(v);
    if (!(column >= 0.0 && row >= 0.0)) return;
    if (!(column < view.image.width && row < view.image.height)) return;
    sheet.dot(x + static_cast<int>(column), y + static_cast<int>(row), colour);
  }
  /// A line, short of both ends.
  /// @param step  between its dots, pixels
  void line(const GridLine& of, double shorter, double step, const Rgb& colour) const {
    const double du = of.u1 - of.u0, dv = of.v1 - of.v0, length = std::hypot(du, dv);
    if (!(length < 2.0 * kMostThumbnailWidth)) return;
    for (double at = shorter; at < length - shorter; at += step) {
      dot(of.u0 + at / length * du, of.v0 + at / length * dv, colour);
    }
  }
};

/// A cross, open at its center.
void draw_mark(const ContactTile& tile, const Mark& mark, const Rgb& colour) {
  for (const int d : {-4, -3, -2, 2, 3, 4}) {
    tile.dot(mark.u + d, mark.v, colour);
    tile.dot(mark.u, mark.v + d, colour);
  }
}

/// A square around a mark.
void draw_square(const ContactTile& tile, const Mark& mark, int half, const Rgb& colour) {
  for (int d = -half; d <= half; ++d) {
    for (const int side : {-half, half}) {
      tile.dot(mark.u + d, mark.v + side, colour);
      tile.dot(mark.u + side, mark.v + d, colour);
    }
  }
}

/// Joins marks that follow each other in the order of their ids, if they are neighbours.
void draw_neighbours(const ContactTile& tile) {
  const std::vector<Mark>& marks = tile.view.marks;
  std::vector<double> steps;
  for (std::size_t i = 1; i < marks.size(); ++i) {
    steps.push_back(std::hypot(marks[i].u - marks[i - 1].u, marks[i].v - marks[i - 1].v));
  }
  if (steps.size() < 3) return;
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  constexpr double kNeighbours = 1.6, kShort = 4.0, kStep = 3.0;  // of the median; pixels
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!(steps[i] <= std::min<double>(kNeighbours * *middle, kThumbnailWidth))) continue;
    const Mark &from = marks[i], &to = marks[i + 1];
    tile.line({from.u, from.v, to.u, to.v}, kShort, kStep, kFoundColour);
  }
}

/// An arrow from a mark past the next one: twice the way, at least 30 pixels.
void draw_arrow(const ContactTile& tile, const Mark& from, const Mark& to, const Rgb& colour) {
  constexpr double kTimes = 2.0, kLeast = 30.0, kShort = 9.0, kHead = 6.0, kStep = 0.5;
  const double du = to.u - from.u, dv = to.v - from.v, way = std::hypot(du, dv);
  if (!(way > 0.0)) return;
  const double length = std::max(kLeast, kTimes * way), x = du / way, y = dv / way;
  if (!(length < kMostThumbnailWidth)) return;
  for (double at = kShort; at < length; at += kStep) {
    const double left = length - at, half = left < kHead ? 0.7 * left : 1.0;
    for (double side = -half; side <= half; side += kStep) {
      tile.dot(from.u + at * x - side * y, from.v + at * y + side * x, colour);
    }
  }
}

/// The first corner, and the way to the next.
void draw_first(const ContactTile& tile) {
  constexpr int kHalf = 7;
  const Mark* first = nullptr;
  for (const Mark& mark : tile.view.marks) {
    if (mark.dropped) continue;
    if (first != nullptr) return draw_arrow(tile, *first, mark, kFirstColour);
    first = &mark;
    draw_square(tile, mark, kHalf, kFirstColour);
    draw_square(tile, mark, kHalf + 1, kFirstColour);
  }
}

constexpr int kSheetColumns = 3, kSheetGap = 6, kReasonLines = 3;

/// "3  a.png  54 corners, 2 dropped, rms 0.08 px"
[[nodiscard]] std::string caption(const Thumbnail& view, int number) {
  std::string text = std::to_string(number) + "  " + view.name;
  if (!view.refusal.empty()) return text;
  std::size_t dropped = 0, fitted = 0;
  double squares = 0.0;
  for (const Mark& mark : view.marks) {
    dropped += mark.dropped ? 1 : 0;
    if (!mark.off || mark.dropped) continue;
    squares += *mark.off * *mark.off;
    ++fitted;
  }
  text += "  " + std::to_string(view.marks.size() - dropped) + " found";
  if (dropped > 0) text += ", " + std::to_string(dropped) + " dropped";
  if (fitted == 0) return text;
  char rms[32];
  (void)std::snprintf(rms, sizeof rms, ", rms %.2f px",
                      std::sqrt(squares / static_cast<double>(fitted)));
  return text + rms;
}

/// Draws a thumbnail and its text at its place.
void draw(ContactPicture& sheet, const Thumbnail& view, int x, int y, int number) {
  for (int v = 0; v < view.image.height; ++v) {
    for (int u = 0; u < view.image.width; ++u) {
      const std::uint8_t gray = view.image(u, v);
      sheet.dot(x + u, y + v, {gray, gray, gray});
    }
  }
  const ContactTile tile{sheet, view, x, y};
  const bool found = view.refusal.empty();
  for (const GridLine& line : view.grid) tile.line(line, 0.0, 0.5, kGridColour);
  if (found && !view.grid.empty()) draw_first(tile);
  if (found && view.grid.empty()) draw_neighbours(tile);
  for (const Mark& mark : view.marks) {
    draw_mark(tile, mark, mark.dropped ? kDroppedColour : found ? kFoundColour : kRefusedColour);
    if (mark.dropped) draw_square(tile, mark, 6, kDroppedColour);
  }
  if (!found) sheet.frame(x, y, view.image.width, view.image.height, kRefusedColour);
  const auto letters = static_cast<std::size_t>(std::max(kThumbnailWidth, view.image.width) /
                                                (kGlyphWidth * ContactPicture::kLetter));
  int line = y + view.image.height + 3;
  sheet.text(x, line, caption(view, number).substr(0, letters), kInk);
  for (int i = 0; i < kReasonLines; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i) * letters;
    if (begin >= view.refusal.size()) break;
    line += kGlyphHeight * ContactPicture::kLetter;
    sheet.text(x, line, std::string_view(view.refusal).substr(begin, letters), kRefusedColour);
  }
}

/// The PNG of some views.
/// @param first  number of the first, from 1
[[nodiscard]] std::string sheet_of(std::span<const Thumbnail> views, int first) {
  int tallest = 0, widest = kThumbnailWidth;
  for (const Thumbnail& view : views) {
    tallest = std::max(tallest, view.image.height);
    widest = std::max(widest, view.image.width);
  }
  const int cell_width = widest + kSheetGap;
  const int cell_height =
      tallest + (kReasonLines + 1) * kGlyphHeight * ContactPicture::kLetter + kSheetGap;
  const int count = static_cast<int>(views.size());
  const int columns = std::min(count, kSheetColumns);
  const int rows = (count + columns - 1) / columns;
  ContactPicture sheet{{columns * cell_width + kSheetGap, rows * cell_height + kSheetGap, kPaper}};
  for (int i = 0; i < count; ++i) {
    draw(sheet, views[static_cast<std::size_t>(i)], kSheetGap + i % columns * cell_width,
         kSheetGap + i / columns * cell_height, first + i);
  }
  return png_bytes(sheet.picture);
}

}  // namespace
}  // namespace detail

Thumbnail thumbnail(const GrayImage& image, std::vector<Mark> marks, const std::string& name,
                    const std::string& refusal, std::vector<GridLine> grid) {
  const int factor = std::max(1, (image.width + kMostThumbnailWidth - 1) / kMostThumbnailWidth);
  Thumbnail small{GrayImage(image.width / factor, image.height / factor), std::move(marks), name,
                  refusal, std::move(grid)};
  for (int v = 0; v < small.image.height; ++v) {
    for (int u = 0; u < small.image.width; ++u) {
      int sum = 0;
      for (int i = 0; i < factor * factor; ++i) {
        sum += image(u * factor + i % factor, v * factor + i / factor);
      }
      small.image(u, v) = static_cast<std::uint8_t>(sum / (factor * factor));
    }
  }
  const auto shrink = [&](double& pixel) {  // the centre of the first pixel is at 0
    pixel = (pixel + 0.5) / factor - 0.5;
  };
  for (Mark& mark : small.marks) shrink(mark.u), shrink(mark.v);
  for (GridLine& line : small.grid) {
    for (double* pixel : {&line.u0, &line.v0, &line.u1, &line.v1}) shrink(*pixel);
  }
  return small;
}

std::vector<std::string> contact_sheets(const std::vector<Thumbnail>& thumbnails) {
  if (thumbnails.empty()) throw std::invalid_argument("a contact sheet needs a view");
  std::vector<std::string> sheets;
  for (std::size_t first = 0; first < thumbnails.size(); first += kViewsOfSheet) {
    const std::size_t count = std::min(kViewsOfSheet, thumbnails.size() - first);
    sheets.push_back(
        detail::sheet_of(std::span(thumbnails).subspan(first, count), static_cast<int>(first) + 1));
  }
  return sheets;
}

std::string sheet_name(const std::string& first, std::size_t number) {
  if (number == 0) return first;
  std::filesystem::path path(first);
  const std::string ending = path.extension().string();
  path.replace_filename(path.stem().string() + "-" + std::to_string(number + 1) + ending);
  return path.string();
}

}  // namespace kinecal
