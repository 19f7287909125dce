// Definitions of view_ahead.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/view_ahead.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

std::optional<double> nearest_ahead(const ScanRanges& scan, const Matrix3<double>& base_R_scanner) {
  constexpr double kAside = 0.5, kSeen = 0.2;  // radians to either side
  constexpr double kLevel = 0.2;               // sine of the slope
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bool is_left = false, is_right = false;
  double nearest = kInfinity;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double angle = scan.angle(i), range = scan.ranges[i];
    const Vector3<double> beam =
        base_R_scanner * Vector3<double>(std::cos(angle), std::sin(angle), 0.0);
    const double aside = std::atan2(beam.y(), beam.x());
    if (std::abs(aside) > kAside || std::abs(beam.z()) > kLevel) continue;
    is_left = is_left || aside >= kSeen;
    is_right = is_right || aside <= -kSeen;
    const bool is_too_near = range == -kInfinity || (range > 0.0 && range < scan.least);
    if (is_too_near) nearest = 0.0;
    if (scan.counts(i)) nearest = std::min(nearest, range);
  }
  return is_left && is_right ? std::optional(nearest) : std::nullopt;
}

void ViewAhead::take_scan(const std::string& topic, const MessageFields& message,
                          std::chrono::steady_clock::time_point arrival) {
  try {
    scans_.insert_or_assign(
        topic, Scan{scan_of(message), std::string(text_at(message, "header.frame_id")), arrival});
  } catch (const std::runtime_error&) {  // the scan before gets old, which stops the base
  }
}

std::optional<RosBase::Ahead> ViewAhead::ahead(const std::string& base) const {
  std::optional<RosBase::Ahead> all;
  for (const auto& [topic, scan] : scans_) {
    const auto base_T_scanner = frames_.pose(base, scan.frame);
    if (!base_T_scanner) continue;
    const auto nearest = nearest_ahead(scan.ranges.view(), base_T_scanner->rotation);
    if (!nearest) continue;
    if (!all) all = {*nearest, scan.arrival};
    all->nearest = std::min(all->nearest, *nearest);
    all->arrival = std::min(all->arrival, scan.arrival);
  }
  return all;
}

std::string ViewAhead::why_none(const std::string& base) const {
  for (const auto& [topic, scan] : scans_) {
    if (frames_.pose(base, scan.frame)) continue;
    return fmt::format(
        "/tf_static does not say how '{}', the frame of {}, is mounted on '{}', the frame of the "
        "odometry",
        printable(scan.frame), printable(topic), printable(base));
  }
  return "there is no scan that shows what is ahead";
}

}  // namespace kinecal::detail
