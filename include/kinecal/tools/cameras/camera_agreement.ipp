// Do images of two cameras that were recorded together show the target at one place?  Files that were paired wrongly, cameras
// that were triggered one after the other or a rig that bends do not.  For start_cameras.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/tools/cameras/camera_places.ipp"

namespace kinecal::detail {

/// How much the place of one camera in another changes from sample to sample, in the quarter of them that agrees best.
struct PlaceChange {
  double angle = 0.0;       ///< rad
  double shift = 0.0;       ///< metres
  double whole = HUGE_VAL;  ///< angle, and shift in parts of the distance of the target
};

/// @param offset  as places_in()
/// @returns  an infinite change if the cameras share too few samples
[[nodiscard]] inline PlaceChange place_change(const SeenTarget& a, const SeenTarget& b,
                                              long offset = 0) {
  constexpr std::size_t kFew = 6;
  const std::vector<Pose<double>> places = places_in(a, b, offset);
  if (places.size() < kFew) return {};
  const Pose<double> middle = *middle_of(places);
  std::vector<double> distances;
  for (const auto& [s, pose] : a.poses) distances.push_back(pose.translation.norm());
  const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), half, distances.end());
  std::vector<PlaceChange> changes;
  for (const Pose<double>& place : places) {
    PlaceChange change;
    change.angle = log(Matrix3<double>(middle.rotation.transpose() * place.rotation)).norm();
    change.shift = (place.translation - middle.translation).norm();
    change.whole = change.angle + change.shift / *half;
    changes.push_back(change);
  }
  const auto quarter = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 4);
  std::nth_element(changes.begin(), quarter, changes.end(),
                   [](const PlaceChange& x, const PlaceChange& y) { return x.whole < y.whole; });
  return *quarter;
}

/// Reports two cameras on one body whose images were not taken together.
inline void check_agreement(const SeenTarget& a, const SeenTarget& b, Diagnostics& diagnostics) {
  constexpr double kMuch = 0.1;    // rad; poses of boards are known ten times as well
  constexpr double kSome = 0.005;  // rad
  constexpr double kClear = 5.0;   // times better with other pairs
  const PlaceChange change = place_change(a, b);
  if (!std::isfinite(change.whole) || change.whole < kSome) return;
  const auto degrees = [](double angle) { return angle * 180.0 / M_PI; };
  for (const long offset : {1L, -1L, 2L, -2L, 3L, -3L}) {
    const PlaceChange other = place_change(a, b, offset);
    if (kClear * other.whole > change.whole) continue;
    diagnostics.error(
        b.pair.camera->place,
        fmt::format("camera '{1}': its images are not those that were taken with the images of "
                    "'{0}': from sample to sample it stands elsewhere, by {2:.2g} deg and {3:.3g} "
                    "mm; with its images of {4} sample{5} {6} it stays where it is, to {7:.2g} deg "
                    "and {8:.2g} mm: pair them so",
                    a.pair.camera->name, b.pair.camera->name, degrees(change.angle),
                    1e3 * change.shift, std::abs(offset), std::abs(offset) == 1 ? "" : "s",
                    offset > 0 ? "later" : "before", degrees(other.angle), 1e3 * other.shift));
    return;
  }
  if (change.whole < kMuch) return;
  diagnostics.error(
      b.pair.camera->place,
      fmt::format(
          "camera '{1}': from sample to sample it stands elsewhere beside '{0}', by {2:.2g} "
          "deg and {3:.3g} mm even in the quarter of the samples that agrees best: were "
          "images that are in one sample taken at once, and are both cameras fixed to one "
          "body?",
          a.pair.camera->name, b.pair.camera->name, degrees(change.angle), 1e3 * change.shift));
}

/// Leaves the views that have half of the corners of the best one: a few corners hardly tell a pose.
[[nodiscard]] inline SeenTarget seen_well(SeenTarget of, const std::vector<Sample>& samples) {
  std::map<std::size_t, std::size_t> corners;
  std::size_t most = 0;
  for (const auto& [s, pose] : of.poses) {
    corners[s] = target_view(of.pair, samples[s]).pixels.size();
    most = std::max(most, corners[s]);
  }
  std::erase_if(of.poses, [&](const auto& pose) { return 2 * corners[pose.first] < most; });
  return of;
}

/// Reports cameras on the base, as check_agreement().
inline void check_agreement(const Config& config, const Robot& robot,
                            const std::vector<SeenTarget>& seen, const std::vector<Sample>& samples,
                            Diagnostics& diagnostics) {
  std::vector<SeenTarget> fixed;
  for (const SeenTarget& of : seen) {
    const std::string& link = of.pair.camera->frame;
    if (!make_chain(robot, config.base_link, link).joints.empty()) continue;
    fixed.push_back(seen_well(of, samples));
  }
  for (std::size_t b = 1; b < fixed.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) check_agreement(fixed[a], fixed[b], diagnostics);
  }
}

}  // namespace kinecal::detail
