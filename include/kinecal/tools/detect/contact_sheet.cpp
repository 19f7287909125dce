// Definitions of contact_sheet.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <utility>

#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/tools/detect/small_font.ipp"

namespace kinecal {
namespace detail {
namespace {

constexpr int kSheetColumns = 3, kSheetGap = 6, kReasonLines = 3;
constexpr Rgb kPaper{245, 245, 245}, kInk{30, 30, 30}, kFoundColour{0, 200, 60},
    kRefusedColour{215, 30, 30}, kGridColour{60, 150, 255}, kDroppedColour{255, 0, 255},
    kFirstColour{255, 140, 0};

/// A picture to draw on; ignores anything outside.
struct Sheet {
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
struct Tile {
  Sheet& sheet;
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
void draw_mark(const Tile& tile, const Mark& mark, const Rgb& colour) {
  for (const int d : {-4, -3, -2, 2, 3, 4}) {
    tile.dot(mark.u + d, mark.v, colour);
    tile.dot(mark.u, mark.v + d, colour);
  }
}

/// A square around a mark.
void draw_square(const Tile& tile, const Mark& mark, int half, const Rgb& colour) {
  for (int d = -half; d <= half; ++d) {
    for (const int side : {-half, half}) {
      tile.dot(mark.u + d, mark.v + side, colour);
      tile.dot(mark.u + side, mark.v + d, colour);
    }
  }
}

/// Joins marks that follow each other in the order of their ids, if they are neighbours.
void draw_neighbours(const Tile& tile) {
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

/// The first corner, and the way to the next.
void draw_first(const Tile& tile) {
  constexpr int kHalf = 7;
  constexpr double kShort = 9.0;
  const Mark* first = nullptr;
  for (const Mark& mark : tile.view.marks) {
    if (mark.dropped) continue;
    if (first != nullptr) {
      for (const int side : {-1, 1}) {  // beside the line of the grid
        tile.line({first->u + side, first->v + side, mark.u + side, mark.v + side}, kShort, 1.0,
                  kFirstColour);
      }
      return;
    }
    first = &mark;
    draw_square(tile, mark, kHalf, kFirstColour);
    draw_square(tile, mark, kHalf + 1, kFirstColour);
  }
}

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
void draw(Sheet& sheet, const Thumbnail& view, int x, int y, int number) {
  for (int v = 0; v < view.image.height; ++v) {
    for (int u = 0; u < view.image.width; ++u) {
      const std::uint8_t gray = view.image(u, v);
      sheet.dot(x + u, y + v, {gray, gray, gray});
    }
  }
  const Tile tile{sheet, view, x, y};
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
                                                (kGlyphWidth * Sheet::kLetter));
  int line = y + view.image.height + 3;
  sheet.text(x, line, caption(view, number).substr(0, letters), kInk);
  for (int i = 0; i < kReasonLines; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i) * letters;
    if (begin >= view.refusal.size()) break;
    line += kGlyphHeight * Sheet::kLetter;
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
  const int cell_height = tallest + (kReasonLines + 1) * kGlyphHeight * Sheet::kLetter + kSheetGap;
  const int count = static_cast<int>(views.size());
  const int columns = std::min(count, kSheetColumns);
  const int rows = (count + columns - 1) / columns;
  Sheet sheet{{columns * cell_width + kSheetGap, rows * cell_height + kSheetGap, kPaper}};
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
