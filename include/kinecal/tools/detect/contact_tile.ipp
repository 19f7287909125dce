// Drawing a view of a contact sheet: its picture, marks, and the grid.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "kinecal/tools/detect/contact_sheet.hpp"
#include "kinecal/tools/detect/small_font.ipp"

namespace kinecal::detail {

inline constexpr Rgb kPaper{245, 245, 245}, kInk{30, 30, 30}, kFoundColour{0, 200, 60},
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
inline void draw_mark(const ContactTile& tile, const Mark& mark, const Rgb& colour) {
  for (const int d : {-4, -3, -2, 2, 3, 4}) {
    tile.dot(mark.u + d, mark.v, colour);
    tile.dot(mark.u, mark.v + d, colour);
  }
}

/// A square around a mark.
inline void draw_square(const ContactTile& tile, const Mark& mark, int half, const Rgb& colour) {
  for (int d = -half; d <= half; ++d) {
    for (const int side : {-half, half}) {
      tile.dot(mark.u + d, mark.v + side, colour);
      tile.dot(mark.u + side, mark.v + d, colour);
    }
  }
}

/// Joins marks that follow each other in the order of their ids, if they are neighbours.
inline void draw_neighbours(const ContactTile& tile) {
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
inline void draw_arrow(const ContactTile& tile, const Mark& from, const Mark& to,
                       const Rgb& colour) {
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
inline void draw_first(const ContactTile& tile) {
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

}  // namespace kinecal::detail
