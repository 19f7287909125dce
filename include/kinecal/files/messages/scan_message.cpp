// Definitions of scan_message.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/scan_message.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/messages/view_message.hpp"

namespace kinecal::detail {

LaserScan scan_of(const MessageFields& message) {
  LaserScan scan;
  for (const MessageValue& range : list_at(message, "ranges")) {
    range.visit_number([&](auto x) { scan.ranges.push_back(static_cast<double>(x)); });
  }
  scan.first_angle = number_at(message, "angle_min");
  scan.step = number_at(message, "angle_increment");
  scan.least = number_at(message, "range_min");
  scan.most = number_at(message, "range_max");
  scan.time_step = number_at(message, "time_increment");
  if (scan.ranges.empty()) throw std::runtime_error("the scan has no ranges");
  if (!std::isfinite(scan.first_angle) || !std::isfinite(scan.step) ||
      (scan.step == 0.0 && scan.ranges.size() > 1)) {
    throw std::runtime_error(
        fmt::format("the scan has {} ranges from angle_min {} in steps of angle_increment {}",
                    scan.ranges.size(), scan.first_angle, scan.step));
  }
  if (!(scan.most > scan.least)) {
    throw std::runtime_error(fmt::format(
        "no range of the scan can count: its range_max, {} m, is not above its range_min, {} m",
        scan.most, scan.least));
  }
  if (!(scan.time_step > 0.0)) scan.time_step = 0.0;
  return scan;
}

PointCloud points_of(const LaserScan& scan) {
  PointCloud points(static_cast<int>(scan.ranges.size()), 1, no_point());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    const bool counts =
        std::isfinite(range) && range > 0.0 && range >= scan.least && range <= scan.most;
    if (!counts) continue;
    const double angle = scan.first_angle + static_cast<double>(i) * scan.step;
    points.pixels[i] =
        Vector3<double>(range * std::cos(angle), range * std::sin(angle), 0.0).cast<float>();
  }
  return points;
}

void read_points(const MessageFields& message, View& view) {
  if (field_at(message, "ranges") == nullptr) return read_cloud(message, view.points, view.image);
  const LaserScan scan = scan_of(message);
  view.points = points_of(scan);
  view.point_time = scan.time_step;
}

}  // namespace kinecal::detail
