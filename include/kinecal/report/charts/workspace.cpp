// Drawing the workspace.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/workspace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "kinecal/report/charts/scatter.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr int kLevels = 5;

/// Limits of points and of their deviations.
struct KnownSpace {
  std::vector<KnownPoint> points;  ///< finite; deviations in millimetres
  std::array<double, 3> low{}, high{};
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

/// The limits include the base, so that people see where the robot is.
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
  return space;
}

/// One view: of points behind one another, draws the most uncertain one.
/// @param up  which coordinate points up in the chart; x points right
void draw_view(Drawing& drawing, const KnownSpace& space, const MapAxes& map, std::size_t up,
               const char* name) {
  constexpr double kCell = 7.0;
  std::map<std::pair<int, int>, KnownPoint> worst;
  for (const KnownPoint& point : space.points) {
    const int column = static_cast<int>(map.x.at(point.p_base[0]) / kCell);
    const int row = static_cast<int>(map.y.at(point.p_base[up]) / kCell);
    const auto [at, added] = worst.try_emplace({row, column}, point);
    if (!added && point.deviation > at->second.deviation) at->second = point;
  }
  drawing.axes(map.area, map.x, map.y, "x, m", name);
  const double area = (map.area.right - map.area.left) * (map.area.bottom - map.area.top);
  const double radius =
      std::clamp(0.36 * std::sqrt(area / static_cast<double>(worst.size())), 3.0, 8.0);
  for (const auto& [cell, point] : worst) {
    const std::string classes = fmt::format("scale{}", space.level(point.deviation) + 1);
    drawing.circle({map.x.at(point.p_base[0]), map.y.at(point.p_base[up])}, radius,
                   classes.c_str());
  }
  const Place base = {map.x.at(0.0), map.y.at(0.0)};
  drawing.line({base[0] - 7.0, base[1]}, {base[0] + 7.0, base[1]}, "zero");
  drawing.line({base[0], base[1] - 7.0}, {base[0], base[1] + 7.0}, "zero");
  drawing.text({base[0] + 5.0, base[1] - 5.0}, "base", "small");
}

[[nodiscard]] std::vector<LegendEntry> level_entries(const KnownSpace& space) {
  static constexpr const char* kClasses[] = {"scale1", "scale2", "scale3", "scale4", "scale5"};
  if (!(space.most > space.least)) {
    return {{Swatch::dot, kClasses[0], figure(space.least) + " mm"}};
  }
  std::vector<LegendEntry> entries;
  for (int i = 0; i < kLevels; ++i) {
    entries.push_back(
        {Swatch::dot, kClasses[i],
         fmt::format("{} – {}{}", figure(space.begin_of(i), 2), figure(space.begin_of(i + 1), 2),
                     i + 1 == kLevels ? " mm" : "")});
  }
  return entries;
}

}  // namespace
}  // namespace detail

std::vector<Chart> workspace_charts(const ReportData& data) {
  const detail::KnownSpace space = detail::known_space(data);
  if (space.points.empty()) return {};
  Chart chart{"workspace", "workspace", "How well the position is known over the workspace",
              "One standard deviation, from above and from the side. Of points behind one another, "
              "the one that is known worst is shown.",
              ""};
  const auto view = [&](std::size_t up, double top) {
    return detail::map_axes({space.low[0], space.low[up]}, {space.high[0], space.high[up]}, top,
                            260.0);
  };
  const detail::MapAxes above = view(1, 62.0), side = view(2, above.area.bottom + 62.0);
  detail::Drawing drawing(chart.name, chart.title, side.area.bottom + 38.0);
  detail::draw_legend(drawing, detail::level_entries(space), 0.0);
  detail::draw_view(drawing, space, above, 1, "y, m: from above");
  detail::draw_view(drawing, space, side, 2, "z, m: from the side");
  chart.svg =
      drawing.str(fmt::format("Standard deviation of the position at {} places, from {} to {} mm.",
                              detail::count_text(space.points.size()), detail::figure(space.least),
                              detail::figure(space.most)));
  return {chart};
}

}  // namespace kinecal
