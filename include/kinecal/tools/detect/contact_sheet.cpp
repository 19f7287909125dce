// Definitions of contact_sheet.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr const char* kSheetHead =
    R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>Contact sheet</title>
<style>
:root { color-scheme: light dark; font: 15px system-ui, "DejaVu Sans", sans-serif; }
main { display: flex; flex-wrap: wrap; gap: 12px; }
figure { margin: 0; max-width: 100%; }
figure div { position: relative; }
figure img { display: block; max-width: 100%; }
.refused div { outline: 2px solid #d71e1e; }
figcaption { white-space: pre-wrap; }
.refused figcaption { contain: inline-size; }
svg { position: absolute; inset: 0; width: 100%; height: 100%; }
path, rect { fill: none; stroke: #00c83c; vector-effect: non-scaling-stroke; }
.refused path { stroke: #d71e1e; }
path.grid { stroke: #3c96ff; }
path.order { stroke-dasharray: 1 2; }
path.dropped, rect.dropped { stroke: #ff00ff; }
path.first, rect.first { stroke: #ff8c00; stroke-width: 2; }
</style></head><body><main>
)";
constexpr const char* kSheetEnd = "</main></body></html>\n";

/// The coordinates of an SVG: there the first pixel ends at 1, in an image its centre is at 0.
[[nodiscard]] ChartPoint point_of(const Mark& mark) {
  return {mark.u + 0.5, mark.v + 0.5};
}

/// True for points in the picture or not far from it.
[[nodiscard]] bool is_near(const ChartPoint& point) {
  constexpr double kMost = 2.0 * kMostThumbnailWidth;
  return std::abs(point[0]) < kMost && std::abs(point[1]) < kMost;
}

/// A cross, open at its center.
void append_mark(std::string& data, const Mark& mark) {
  const auto [x, y] = point_of(mark);
  for (const auto& [dx, dy] : {ChartPoint{-4.0, 0.0}, {2.0, 0.0}, {0.0, -4.0}, {0.0, 2.0}}) {
    data += "M" + coordinate(x + dx) + " " + coordinate(y + dy) + (dx == 0.0 ? "v2" : "h2");
  }
}

void draw_square(Drawing& drawing, const Mark& mark, double half, const char* classes) {
  const auto [x, y] = point_of(mark);
  drawing.rectangle({x - half, y - half}, 2.0 * half, 2.0 * half, classes);
}

/// Joins marks that follow each other in the order of their ids, if they are neighbours.
void draw_neighbours(Drawing& drawing, const std::vector<Mark>& marks) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < marks.size(); ++i) {
    steps.push_back(std::hypot(marks[i].u - marks[i - 1].u, marks[i].v - marks[i - 1].v));
  }
  if (steps.size() < 3) return;
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  constexpr double kNeighbours = 1.6;  // of the median
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const ChartPoint from = point_of(marks[i]), to = point_of(marks[i + 1]);
    const bool joined = steps[i] <= std::min<double>(kNeighbours * *middle, kThumbnailWidth);
    if (joined && is_near(from) && is_near(to)) drawing.line(from, to, "order");
  }
}

/// The first corner, and an arrow past the next one: twice the way, at least 30 pixels.
void draw_first(Drawing& drawing, const std::vector<Mark>& marks) {
  constexpr double kHalf = 7.0, kTimes = 2.0, kLeast = 30.0, kHead = 6.0;
  const auto is_kept = [](const Mark& mark) { return !mark.dropped && is_near(point_of(mark)); };
  const auto first = std::find_if(marks.begin(), marks.end(), is_kept);
  if (first == marks.end()) return;
  draw_square(drawing, *first, kHalf, "first");
  const auto next = std::find_if(first + 1, marks.end(), is_kept);
  if (next == marks.end()) return;
  const ChartPoint corner = point_of(*first);
  const double du = next->u - first->u, dv = next->v - first->v, way = std::hypot(du, dv);
  if (!(way > 0.0)) return;
  const double x = du / way, y = dv / way, length = std::max(kLeast, kTimes * way);
  const auto at = [&](double along, double side) {
    return ChartPoint{corner[0] + along * x - side * y, corner[1] + along * y + side * x};
  };
  drawing.line(at(kHalf, 0.0), at(length, 0.0), "first");
  drawing.curve(std::vector<ChartPoint>{at(length - kHead, kHead), at(length, 0.0),
                                        at(length - kHead, -kHead)},
                "first");
}

/// "3  a.png  54 found, 2 dropped, rms 0.08 px"
[[nodiscard]] std::string caption(const Thumbnail& view, std::size_t number) {
  const std::string text = fmt::format("{}  {}", number, view.name);
  if (!view.refusal.empty()) return text;
  std::size_t dropped = 0, fitted = 0;
  double squares = 0.0;
  for (const Mark& mark : view.marks) {
    dropped += mark.dropped ? 1 : 0;
    if (!mark.off || mark.dropped) continue;
    squares += *mark.off * *mark.off;
    ++fitted;
  }
  return text + fmt::format("  {} found", view.marks.size() - dropped) +
         (dropped > 0 ? fmt::format(", {} dropped", dropped) : "") +
         (fitted > 0
              ? fmt::format(", rms {:.2f} px", std::sqrt(squares / static_cast<double>(fitted)))
              : "");
}

/// A view: its image, what was found drawn over it, and the text below.
[[nodiscard]] std::string html_view(const Thumbnail& view, std::size_t number) {
  const bool found = view.refusal.empty();
  const std::string words = caption(view, number);
  Drawing drawing(fmt::format("view-{}", number), view.name, view.image.height, view.image.width);
  for (const GridLine& line : view.grid) {
    const ChartPoint from = point_of({line.u0, line.v0}), to = point_of({line.u1, line.v1});
    if (is_near(from) && is_near(to)) drawing.line(from, to, "grid");
  }
  if (found && !view.grid.empty()) draw_first(drawing, view.marks);
  if (found && view.grid.empty()) draw_neighbours(drawing, view.marks);
  for (const Mark& mark : view.marks) {
    if (!is_near(point_of(mark))) continue;
    std::string cross;
    append_mark(cross, mark);
    drawing.path(cross, mark.dropped ? "dropped" : "found", 0, mark.label);
    if (mark.dropped) draw_square(drawing, mark, 6.0, "dropped");
  }
  return fmt::format(
      "<figure{}><div><img alt=\"\" src=\"data:image/png;base64,{}\">\n{}</div>"
      "<figcaption>{}{}{}</figcaption></figure>\n",
      found ? "" : " class=\"refused\"", base64(png_bytes(view.image)),
      drawing.str(words + " " + view.refusal), svg_escaped(words), found ? "" : "<br>",
      svg_escaped(view.refusal));
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

std::vector<std::string> contact_sheets(const std::vector<Thumbnail>& thumbnails,
                                        const std::vector<std::string>& earlier) {
  if (thumbnails.empty()) throw std::invalid_argument("a contact sheet needs a view");
  std::vector<std::string> sheets;
  for (std::size_t i = 0; i < earlier.size() + thumbnails.size(); ++i) {
    if (i % kViewsOfSheet == 0) sheets.emplace_back(detail::kSheetHead);
    sheets.back() +=
        i < earlier.size() ? earlier[i] : detail::html_view(thumbnails[i - earlier.size()], i + 1);
  }
  for (std::string& sheet : sheets) sheet += detail::kSheetEnd;
  return sheets;
}

std::optional<std::vector<std::string>> views_of_sheet(std::string_view page) {
  constexpr std::string_view kEnd = "</figure>\n";
  const std::string_view head = detail::kSheetHead, end = detail::kSheetEnd;
  if (!page.starts_with(head) || !page.ends_with(end)) return std::nullopt;
  page.remove_prefix(head.size());
  page.remove_suffix(end.size());
  std::vector<std::string> views;
  while (!page.empty()) {
    const std::size_t at = page.find(kEnd);
    if (at == std::string_view::npos) return std::nullopt;
    views.emplace_back(page.substr(0, at + kEnd.size()));
    page.remove_prefix(at + kEnd.size());
  }
  return views;
}

std::string sheet_name(const std::string& first, std::size_t number) {
  std::filesystem::path path(first);
  const std::string ending = path.extension().string();
  if (ending == ".png" || ending == ".PNG") path.replace_extension(".html");
  if (number == 0) return path.string();
  const std::string name = path.stem().string() + "-" + std::to_string(number + 1);
  return path.replace_filename(name + path.extension().string()).string();
}

}  // namespace kinecal
