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
#include "kinecal/tools/detect/contact_tile.ipp"

namespace kinecal {
namespace detail {
namespace {

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
