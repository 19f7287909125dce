// Definitions of contact_sheet.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/tools/detect/small_font.ipp"

namespace kinecal {
namespace detail {
namespace {

constexpr int kSheetColumns = 3, kSheetGap = 6, kReasonLines = 3;
constexpr Rgb kPaper{245, 245, 245}, kInk{30, 30, 30}, kFoundColour{0, 200, 60},
    kRefusedColour{215, 30, 30};

/// A picture to draw on; ignores anything outside.
struct Sheet {
  Image<Rgb> picture;

  void dot(int x, int y, const Rgb& colour) {
    if (picture.contains(x, y)) picture(x, y) = colour;
  }
  void text(int x, int y, std::string_view words, const Rgb& colour) {
    for_pixels_of(words, [&](int dx, int dy) { dot(x + dx, y + dy, colour); });
  }
  void frame(int x, int y, int width, int height, const Rgb& colour) {
    for (int i = 0; i < width; ++i) {
      for (const int row : {0, 1, height - 2, height - 1}) dot(x + i, y + row, colour);
    }
    for (int i = 0; i < height; ++i) {
      for (const int column : {0, 1, width - 2, width - 1}) dot(x + column, y + i, colour);
    }
  }
};

/// A cross, open at its center.
void draw_mark(Sheet& sheet, int x, int y, const Rgb& colour) {
  for (const int d : {-3, -2, -1, 1, 2, 3}) {
    sheet.dot(x + d, y, colour);
    sheet.dot(x, y + d, colour);
  }
}

/// A dotted line between two marks, short of both.
void draw_dots(Sheet& sheet, const Mark& from, const Mark& to, int x, int y, const Rgb& colour) {
  constexpr double kShort = 4.0, kStep = 3.0;  // pixels
  const double du = to.u - from.u, dv = to.v - from.v, length = std::hypot(du, dv);
  for (double at = kShort; at < length - kShort; at += kStep) {
    sheet.dot(x + static_cast<int>(std::lround(from.u + at / length * du)),
              y + static_cast<int>(std::lround(from.v + at / length * dv)), colour);
  }
}

/// Joins marks that follow each other in the order of their ids, if they are neighbours.
void draw_grid(Sheet& sheet, const Thumbnail& view, int x, int y) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < view.marks.size(); ++i) {
    steps.push_back(
        std::hypot(view.marks[i].u - view.marks[i - 1].u, view.marks[i].v - view.marks[i - 1].v));
  }
  if (steps.size() < 3) return;
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  constexpr double kNeighbours = 1.6;  // of the median
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!(steps[i] <= std::min<double>(kNeighbours * *middle, kThumbnailWidth))) continue;
    draw_dots(sheet, view.marks[i], view.marks[i + 1], x, y, kFoundColour);
  }
}

/// Draws a thumbnail and its text at its place.
void draw(Sheet& sheet, const Thumbnail& view, int x, int y) {
  for (int v = 0; v < view.image.height; ++v) {
    for (int u = 0; u < view.image.width; ++u) {
      const std::uint8_t gray = view.image(u, v);
      sheet.dot(x + u, y + v, {gray, gray, gray});
    }
  }
  const bool found = view.refusal.empty();
  const Rgb& colour = found ? kFoundColour : kRefusedColour;
  for (const Mark& mark : view.marks) {
    const double u = std::round(mark.u), v = std::round(mark.v);
    const bool inside = u >= 0 && v >= 0 && u < view.image.width && v < view.image.height;
    if (inside) draw_mark(sheet, x + static_cast<int>(u), y + static_cast<int>(v), colour);
  }
  if (found) draw_grid(sheet, view, x, y);
  if (!found) sheet.frame(x, y, view.image.width, view.image.height, kRefusedColour);
  constexpr std::size_t kLetters = kThumbnailWidth / kGlyphWidth;
  int line = y + view.image.height + 3;
  const std::string count = found ? "  " + std::to_string(view.marks.size()) : "";
  sheet.text(x, line, (view.name + count).substr(0, kLetters), kInk);
  for (int i = 0; i < kReasonLines; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i) * kLetters;
    if (begin >= view.refusal.size()) break;
    line += kGlyphHeight;
    sheet.text(x, line, std::string_view(view.refusal).substr(begin, kLetters), kRefusedColour);
  }
}

}  // namespace
}  // namespace detail

Thumbnail thumbnail(const GrayImage& image, std::vector<Mark> marks, const std::string& name,
                    const std::string& refusal) {
  const int factor = std::max(1, (image.width + kThumbnailWidth - 1) / kThumbnailWidth);
  Thumbnail small{GrayImage(image.width / factor, image.height / factor), std::move(marks), name,
                  refusal};
  for (int v = 0; v < small.image.height; ++v) {
    for (int u = 0; u < small.image.width; ++u) {
      int sum = 0;
      for (int i = 0; i < factor * factor; ++i) {
        sum += image(u * factor + i % factor, v * factor + i / factor);
      }
      small.image(u, v) = static_cast<std::uint8_t>(sum / (factor * factor));
    }
  }
  for (Mark& mark : small.marks) {  // the centre of the first pixel is at 0
    mark.u = (mark.u + 0.5) / factor - 0.5;
    mark.v = (mark.v + 0.5) / factor - 0.5;
  }
  return small;
}

std::string contact_sheet(const std::vector<Thumbnail>& thumbnails) {
  if (thumbnails.empty()) throw std::invalid_argument("a contact sheet needs a view");
  int tallest = 0;
  for (const Thumbnail& view : thumbnails) tallest = std::max(tallest, view.image.height);
  const int cell_width = kThumbnailWidth + detail::kSheetGap;
  const int cell_height =
      tallest + (detail::kReasonLines + 1) * detail::kGlyphHeight + detail::kSheetGap;
  const int count = static_cast<int>(thumbnails.size());
  const int columns = std::min(count, detail::kSheetColumns);
  const int rows = (count + columns - 1) / columns;
  detail::Sheet sheet{{columns * cell_width + detail::kSheetGap,
                       rows * cell_height + detail::kSheetGap, detail::kPaper}};
  for (int i = 0; i < count; ++i) {
    detail::draw(sheet, thumbnails[static_cast<std::size_t>(i)],
                 detail::kSheetGap + i % columns * cell_width,
                 detail::kSheetGap + i / columns * cell_height);
  }
  return detail::png_bytes(sheet.picture);
}

}  // namespace kinecal
