// Definitions of start_cameras.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/start_cameras.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/cameras/camera_checks.ipp"
#include "kinecal/config/cameras/camera_places.ipp"
#include "kinecal/config/cameras/known_cameras.ipp"
#include "kinecal/config/cameras/single_camera.hpp"
#include "kinecal/config/cameras/target_poses.ipp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal {

namespace detail {
namespace {

// Do images of two cameras that were recorded together show the target at one place?  Files that were paired wrongly, cameras
// that were triggered one after the other or a rig that bends do not.  For start_cameras.cpp.

/// How much the place of one camera in another changes from sample to sample, in the quarter of them that agrees best.
struct PlaceChange {
  double angle = 0.0;       ///< rad
  double shift = 0.0;       ///< metres
  double whole = HUGE_VAL;  ///< angle, and shift in parts of the distance of the target
};

/// @param offset  as places_in()
/// @returns  an infinite change if the cameras share too few samples
[[nodiscard]] PlaceChange place_change(const SeenTarget& a, const SeenTarget& b, long offset = 0) {
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
void check_agreement(const SeenTarget& a, const SeenTarget& b, Diagnostics& diagnostics) {
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
[[nodiscard]] SeenTarget seen_well(SeenTarget of, const std::vector<Sample>& samples) {
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
void check_agreement(const Config& config, const Robot& robot, const std::vector<SeenTarget>& seen,
                     const std::vector<Sample>& samples, Diagnostics& diagnostics) {
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

/// The size of a camera's image: as recorded, or as far as corners lie around its middle.
[[nodiscard]] std::array<double, 2> image_size_of(const CameraInfo* info,
                                                  std::span<const TargetView> views) {
  if (info != nullptr && info->width > 0 && info->height > 0) {
    return {double(info->width), double(info->height)};
  }
  Eigen::AlignedBox2d box;
  for (const TargetView& view : views) {
    for (const Eigen::Vector2d& pixel : view.pixels) box.extend(pixel);
  }
  return {box.min().x() + box.max().x() + 1.0, box.min().y() + box.max().y() + 1.0};
}

/// False if a camera was not found: no lens images the target as it was seen.
[[nodiscard]] bool is_finite(const CameraInfo& info) {
  const auto number = [](double value) { return std::isfinite(value); };
  return std::all_of(info.k.begin(), info.k.end(), number) &&
         std::all_of(info.d.begin(), info.d.end(), number);
}

/// True if all intrinsics of a camera are free in some step.
[[nodiscard]] bool has_free_intrinsics(const Config& config, const ModelConfig& camera) {
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  const auto all = sensor->parameters().first(kIntrinsics);
  return std::all_of(all.begin(), all.end(), [&](const ParameterInfo& info) {
    return is_free(config, parameter_name(camera.param_name, info.name));
  });
}

}  // namespace
}  // namespace detail

void start_cameras(Config& config, const Robot& robot, std::vector<Sample>& samples,
                   Diagnostics& diagnostics) {
  const std::vector<detail::TargetPair> pairs = detail::target_pairs(config, robot);
  if (!detail::check_sensors(config, pairs, samples, diagnostics)) return;
  std::vector<detail::SeenTarget> seen;
  for (const detail::TargetPair& pair : pairs) {
    const std::vector<TargetView> views = detail::views_of(pair, samples);
    const CameraInfo* info = detail::info_of(pair.camera->name, samples);
    if (!detail::check_sizes(*pair.camera, samples, diagnostics)) continue;
    detail::SeenTarget of{pair, {}};
    if (detail::is_known(info)) {
      of.poses = detail::poses_by(*info, pair.camera->image, views);
    } else {
      if (!detail::has_free_intrinsics(config, *pair.camera)) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{0}': its intrinsics are not known; free {0}_fx, "
                                      "{0}_fy, {0}_cx, {0}_cy and the coefficients of its lens, or "
                                      "give them",
                                      pair.camera->param_name));
        continue;
      }
      const std::array<double, 2> size = detail::image_size_of(info, views);
      auto single = single_camera(views, size[0], size[1], detail::options_of(*pair.camera).lens);
      if (!single) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{}': no view of '{}' has four corners of a flat "
                                      "target, so nothing says where to begin; give its "
                                      "intrinsics",
                                      pair.camera->name, pair.target->name));
        continue;
      }
      if (!detail::is_finite(single->info)) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{}': no lens fits its views of '{}'; are the "
                                      "columns, rows and ids of the target right?",
                                      pair.camera->name, pair.target->name));
        continue;
      }
      if (!pair.camera->lens.empty()) detail::drop_held(config, *pair.camera, single->info);
      detail::set_info(pair.camera->name, single->info, samples);
      for (std::size_t s = 0; s < views.size(); ++s) {
        if (single->poses[s]) of.poses.emplace(s, *single->poses[s]);
      }
    }
    detail::drop_unseen(pair, *detail::info_of(pair.camera->name, samples), views, of.poses);
    seen.push_back(std::move(of));
  }
  detail::check_agreement(config, robot, seen, samples, diagnostics);
  const auto cameras = detail::place(config, robot, seen, samples);
  for (const detail::SeenTarget& of : seen) {
    const bool is_lost = detail::is_placed_by_us(config, robot, *of.pair.camera) &&
                         !cameras.contains(of.pair.camera->name);
    if (!is_lost) continue;
    diagnostics.error(
        of.pair.camera->place,
        fmt::format("camera '{}' shares no sample with a camera whose place on the base is known; "
                    "record the target where both see it, or give its frame an initial value",
                    of.pair.camera->name));
  }
  if (diagnostics.errors.empty()) detail::drop_unplaced(pairs, samples, diagnostics);
}

}  // namespace kinecal
