// Drawing the workspace.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/workspace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "kinecal/report/charts/scatter.hpp"
#include "kinecal/report/svg_axis.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr int kLevels = 5;

/// Points in cells of a round size, their limits, and those of their deviations.
struct KnownSpace {
  std::vector<KnownPoint> points;  ///< finite; deviations in millimetres
  std::array<double, 3> low{}, high{};
  double cell = 0.1;               ///< metres
  double least = 0.0, most = 0.0;  ///< mm

  /// From 0 to kLevels - 1.
  [[nodiscard]] int level(double deviation) const {
    const double share = most > least ? (deviation - least) / (most - least) : 0.0;
    return std::clamp(static_cast<int>(share * kLevels), 0, kLevels - 1);
  }
  /// The lower end of a level, mm.
  [[nodiscard]] double begin_of(int level) const {
    return least + (most - least) * level / kLevels;
  }
};

/// The limits include the base, so that people see where the robot is, and are those of cells.
[[nodiscard]] KnownSpace known_space(const ReportData& data) {
  KnownSpace space;
  constexpr double kFarthest = 1e4;  // metres
  for (KnownPoint point : data.workspace) {
    const auto [x, y, z] = point.p_base;
    const bool near = std::abs(x) < kFarthest && std::abs(y) < kFarthest && std::abs(z) < kFarthest;
    if (!near || !std::isfinite(point.deviation)) continue;
    point.deviation *= people_factor("m");
    space.least = space.points.empty() ? point.deviation : std::min(space.least, point.deviation);
    space.most = std::max(space.most, point.deviation);
    for (std::size_t i = 0; i < 3; ++i) {
      space.low[i] = std::min(space.low[i], point.p_base[i]);
      space.high[i] = std::max(space.high[i], point.p_base[i]);
    }
    space.points.push_back(point);
  }
  constexpr int kCells = 24;  // over the longest side
  double longest = 1e-3;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, space.high[i] - space.low[i]);
  space.cell = round_step(longest, kCells);
  for (std::size_t i = 0; i < 3; ++i) {
    space.low[i] = space.cell * std::floor(space.low[i] / space.cell);
    space.high[i] = space.cell * (std::floor(space.high[i] / space.cell) + 1.0);
  }
  return space;
}

/// The place of the robot's base: a cross with its name, legible on cells.
void draw_base(Drawing& drawing, const MapAxes& map) {
  constexpr double kArm = 8.0;
  const ChartPoint base = {map.x.at(0.0), map.y.at(0.0)};
  drawing.line({base[0] - kArm, base[1]}, {base[0] + kArm, base[1]}, "zero");
  drawing.line({base[0], base[1] - kArm}, {base[0], base[1] + kArm}, "zero");
  drawing.circle(base, 3.0, "ring");
  const bool at_right = base[0] > map.x.to() - 40.0;
  drawing.text({base[0] + (at_right ? -6.0 : 6.0), base[1] - 6.0}, "base", "small strong halo",
               at_right ? Anchor::end : Anchor::start);
}

/// One view, in cells; each has the colour of its most uncertain point, and those without one are blank.
/// @param up  which coordinate points up in the chart; x points right
void draw_view(Drawing& drawing, const KnownSpace& space, const MapAxes& map, std::size_t up,
               const char* name) {
  std::map<std::pair<int, int>, double> worst;
  const auto cell_of = [&](double at) { return static_cast<int>(std::floor(at / space.cell)); };
  for (const KnownPoint& point : space.points) {
    const std::pair cell(cell_of(point.p_base[up]), cell_of(point.p_base[0]));
    const auto [at, added] = worst.try_emplace(cell, point.deviation);
    if (!added) at->second = std::max(at->second, point.deviation);
  }
  drawing.axes(map.area, map.x, map.y, "x, m", name);
  for (const auto& [cell, deviation] : worst) {
    const double left = map.x.at(space.cell * cell.second);
    const double top = map.y.at(space.cell * (cell.first + 1));
    const double width = map.x.at(space.cell * (cell.second + 1)) - left;
    const std::string classes = fmt::format("scale{}", space.level(deviation) + 1);
    drawing.rectangle({left, top}, width, width, classes.c_str(), figure(deviation) + " mm");
  }
  draw_base(drawing, map);
}

/// The colours with the deviations at their borders.
void draw_color_bar(Drawing& drawing, const KnownSpace& space) {
  constexpr double kLeft = 46.0, kWidth = 66.0, kTop = 20.0, kHigh = 12.0;
  drawing.text({2.0, 12.0}, "standard deviation of the position, mm", "name");
  const int levels = space.most > space.least ? kLevels : 1;
  for (int i = 0; i < levels; ++i) {
    const std::string classes = fmt::format("scale{}", i + 1);
    drawing.rectangle({kLeft + kWidth * i, kTop}, kWidth, kHigh, classes.c_str());
  }
  for (int i = 0; i <= levels; ++i) {
    const double at = kLeft + kWidth * i;
    if (levels == 1 && i == 1) break;
    drawing.text({levels == 1 ? at + 0.5 * kWidth : at, kTop + kHigh + 14.0},
                 figure(space.begin_of(i), 2), "small figure", Anchor::middle);
  }
}

}  // namespace
}  // namespace detail

std::vector<Chart> workspace_charts(const ReportData& data) {
  const detail::KnownSpace space = detail::known_space(data);
  if (space.points.empty()) return {};
  Chart chart{
      "workspace", "workspace", "How well the position is known over the workspace",
      fmt::format("One standard deviation, from above and from the side. A cell is {} m wide "
                  "and shows the place in it that is known worst; blank cells are out of "
                  "reach or were not tried.",
                  detail::figure(space.cell)),
      ""};
  const auto view = [&](std::size_t up, double top) {
    return detail::map_axes({space.low[0], space.low[up]}, {space.high[0], space.high[up]}, top,
                            300.0);
  };
  const detail::MapAxes above = view(1, 84.0), side = view(2, above.area.bottom + 62.0);
  detail::Drawing drawing(chart.name, chart.title, side.area.bottom + 38.0);
  detail::draw_color_bar(drawing, space);
  detail::draw_view(drawing, space, above, 1, "y, m: from above");
  detail::draw_view(drawing, space, side, 2, "z, m: from the side");
  chart.svg =
      drawing.str(fmt::format("Standard deviation of the position at {} places, from {} to {} mm.",
                              detail::count_text(space.points.size()), detail::figure(space.least),
                              detail::figure(space.most)));
  return {chart};
}

}  // namespace kinecal
