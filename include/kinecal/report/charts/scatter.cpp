// Drawing points.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/scatter.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace kinecal::detail {

std::vector<ChartPoint> running_median(std::vector<ScatterPoint> points) {
  constexpr std::size_t kLeast = 10, kInGroup = 8, kMostGroups = 20;
  std::erase_if(points,
                [](const ScatterPoint& p) { return !std::isfinite(p.x) || !std::isfinite(p.y); });
  if (points.size() < kLeast) return {};
  std::stable_sort(points.begin(), points.end(),
                   [](const ScatterPoint& a, const ScatterPoint& b) { return a.x < b.x; });
  const std::size_t groups = std::clamp<std::size_t>(points.size() / kInGroup, 1, kMostGroups);
  std::vector<ChartPoint> medians;
  for (std::size_t g = 0; g < groups; ++g) {
    std::vector<double> xs, ys;
    for (std::size_t i = g * points.size() / groups; i < (g + 1) * points.size() / groups; ++i) {
      xs.push_back(points[i].x);
      ys.push_back(points[i].y);
    }
    std::sort(ys.begin(), ys.end());
    medians.push_back({quantile(xs, 0.5), quantile(ys, 0.5)});
  }
  return medians;
}

Axis signed_axis(const std::vector<ScatterPoint>& points, double bottom, double top) {
  std::vector<double> sizes;
  for (const ScatterPoint& point : points) sizes.push_back(std::abs(point.y));
  const std::vector<double> sorted = sorted_finite(sizes);
  constexpr double kNearlyAll = 0.95, kRoom = 2.5;
  const double usual = kRoom * quantile(sorted, kNearlyAll);
  const double most = sorted.empty() ? 0.0 : std::min(sorted.back(), usual);
  return Axis::linear(-most, most, bottom, top);
}

std::size_t draw_scatter(Drawing& drawing, const std::vector<ScatterPoint>& points, const Axis& x,
                         const Axis& y) {
  std::vector<double> sizes;
  for (const ScatterPoint& point : points) {
    sizes.push_back(std::isfinite(point.x) ? std::abs(point.y) : point.x);
  }
  const auto chosen = chosen_marks(sizes);
  std::map<int, std::string> dots;
  for (const std::size_t i : chosen) {
    append_dot(dots[points[i].sample], {x.at(points[i].x), y.at(points[i].y)});
  }
  constexpr std::size_t kFew = 100;
  drawing.open_group(chosen.size() <= kFew ? "dots" : "dots small");
  for (const auto& [sample, path] : dots) drawing.path(path, "", sample);
  drawing.close_group();
  std::vector<ChartPoint> medians = running_median(points);
  for (ChartPoint& median : medians) median = {x.at(median[0]), y.at(median[1])};
  drawing.curve(medians, "median");
  return chosen.size();
}

MapAxes map_axes(std::array<double, 2> low, std::array<double, 2> high, double top,
                 double most_height) {
  PlotArea area{46.0, top, kChartWidth - 12.0, top};
  const double width = area.right - area.left;
  for (int i = 0; i < 2; ++i) {
    const double room = 0.05 * std::max(high[0] - low[0], high[1] - low[1]);
    low[i] -= room > 0.0 && std::isfinite(room) ? room : 0.1;
    high[i] += room > 0.0 && std::isfinite(room) ? room : 0.1;
  }
  const double height =
      std::clamp(width * (high[1] - low[1]) / (high[0] - low[0]), 0.3 * width, most_height);
  area.bottom = top + height;
  // Equal scale: extends the axis with room to spare.
  const double scale = std::max((high[0] - low[0]) / width, (high[1] - low[1]) / height);
  const auto extended = [&](int i, double size) {
    const double middle = 0.5 * (low[i] + high[i]), half = 0.5 * scale * size;
    return std::array<double, 2>{middle - half, middle + half};
  };
  const auto [x_low, x_high] = extended(0, width);
  const auto [y_low, y_high] = extended(1, height);
  return {Axis::exact(x_low, x_high, area.left, area.right),
          Axis::exact(y_low, y_high, area.bottom, area.top), area};
}

}  // namespace kinecal::detail
