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
  constexpr double kLongest = 60.0;  // seconds of a scan: beyond, the time step has another unit
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
  const double time = scan.time_step * static_cast<double>(scan.ranges.size());
  if (!(scan.time_step > 0.0) || !(time <= kLongest)) scan.time_step = 0.0;
  return scan;
}

PointCloud points_of(const LaserScan& scan) {
  PointCloud points(static_cast<int>(scan.ranges.size()), 1, no_point());
  const ScanRanges beams = scan.view();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!beams.counts(i)) continue;
    const double range = scan.ranges[i], angle = beams.angle(i);
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
