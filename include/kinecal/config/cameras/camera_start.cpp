// Definitions of camera_start.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/camera_start.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/capture/boards/target_pose.hpp"
#include "kinecal/geometry/median.hpp"

namespace kinecal {

Vector3<double> CameraStart::direction(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d from = pixel - center;
  const double radius = from.norm(), angle = lens.inverse(radius / lens.focal);
  if (!(angle < std::numbers::pi)) {
    return Vector3<double>::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  const double sine = radius > 0.0 ? std::sin(angle) / radius : 0.0;
  return {sine * from.x(), sine * from.y(), std::cos(angle)};
}

Eigen::Vector2d CameraStart::pixel(const Vector3<double>& point) const {
  const double beside = point.head<2>().norm(), angle = std::atan2(beside, point.z());
  if (!(beside > 0.0)) return center;
  return center + lens.focal * lens.profile(angle) / beside * point.head<2>();
}

namespace detail {
namespace {

/// The corners of a view that a camera can see, and where.
struct SeenCorners {
  SeenCorners(const TargetView& view, const PixelDirection& direction) {
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      const Vector3<double> to = direction(view.pixels[i]);
      if (!to.allFinite()) continue;
      plane.push_back(view.plane[i]);
      directions.push_back(to);
    }
  }
  std::vector<Eigen::Vector2d> plane;
  std::vector<Vector3<double>> directions;
};

}  // namespace
}  // namespace detail

std::optional<Pose<double>> CameraStart::pose(const TargetView& view) const {
  const detail::SeenCorners seen(view,
                                 [this](const Eigen::Vector2d& pixel) { return direction(pixel); });
  return seen.plane.size() < 4 ? std::nullopt : plane_pose(seen.plane, seen.directions);
}

std::optional<Pose<double>> pose_of_view(const TargetView& view, const PixelDirection& direction) {
  const detail::SeenCorners seen(view, direction);
  if (seen.plane.size() < 4) return std::nullopt;
  std::vector<Vector3<double>> points;
  for (const Eigen::Vector2d& p : seen.plane) points.emplace_back(p.x(), p.y(), 0.0);
  const auto fit = fit_target(std::move(points), seen.directions, 1.0);
  return fit ? std::optional(fit->pose) : std::nullopt;
}

std::vector<TargetView> telling_views(std::span<const TargetView> views, std::size_t most) {
  std::vector<const TargetView*> order;
  for (const TargetView& view : views) order.push_back(&view);
  std::stable_sort(order.begin(), order.end(), [](const TargetView* a, const TargetView* b) {
    return a->pixels.size() > b->pixels.size();
  });
  std::vector<TargetView> some;
  const std::size_t step = std::max<std::size_t>(1, order.size() / most);
  for (std::size_t i = 0; i < order.size() && some.size() < most; i += step) {
    some.push_back(*order[i]);
  }
  return some;
}

double farthest_degrees(std::span<const TargetView> views, const PixelDirection& direction) {
  double most = 0.0;
  for (const TargetView& view : views) {
    for (const Eigen::Vector2d& pixel : view.pixels) {
      const Vector3<double> to = direction(pixel);
      if (to.allFinite()) most = std::max(most, std::atan2(to.head<2>().norm(), to.z()));
    }
  }
  return most * 180.0 / std::numbers::pi;
}

namespace detail {
namespace {

/// Distances of the corners of a view from where its pose puts them, pixels.
void add_misses(const CameraStart& camera, const TargetView& view, std::vector<double>& misses) {
  const auto pose = camera.pose(view);
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    double miss = std::numeric_limits<double>::infinity();
    if (pose) {
      const Vector3<double> p = *pose * Vector3<double>(view.plane[i].x(), view.plane[i].y(), 0.0);
      const double off = (camera.pixel(p) - view.pixels[i]).norm();
      if (std::isfinite(off)) miss = off;
    }
    misses.push_back(miss);
  }
}

/// A rough camera, judged by some views.
[[nodiscard]] CameraStart judged(RoundLens lens, const Eigen::Vector2d& center,
                                 std::span<const TargetView> views) {
  CameraStart camera{std::move(lens), center};
  std::vector<double> misses;
  for (const TargetView& view : views) add_misses(camera, view, misses);
  camera.typical = misses.empty() ? std::numeric_limits<double>::infinity() : median_of(misses);
  return camera;
}

}  // namespace
}  // namespace detail

std::optional<CameraStart> camera_start(std::span<const TargetView> views, double width,
                                        double height) {
  constexpr std::size_t kEnough = 16;
  const std::vector<TargetView> some = telling_views(views, kEnough);
  const Eigen::Vector2d center(0.5 * (width - 1.0), 0.5 * (height - 1.0));
  const double size = std::max(width, height);
  std::optional<CameraStart> best;
  RoundLens (*best_kind)(double) = nullptr;
  const auto attempt = [&](RoundLens (*kind)(double), double focal) {
    CameraStart camera = detail::judged(kind(focal), center, some);
    if (!std::isfinite(camera.typical) || (best && best->typical <= camera.typical)) return;
    best = std::move(camera);
    best_kind = kind;
  };
  constexpr double kLeast = 0.1, kMost = 10.0, kStep = 1.12;  // of the image's size
  for (const auto kind : {&rough_pinhole, &rough_fisheye}) {
    for (double focal = kLeast * size; focal < kMost * size; focal *= kStep) attempt(kind, focal);
  }
  if (!best) return std::nullopt;
  for (double step = std::sqrt(kStep); step > 1.0005; step = std::sqrt(step)) {
    const double focal = best->lens.focal;
    attempt(best_kind, focal * step);
    attempt(best_kind, focal / step);
  }
  best->most_degrees =
      farthest_degrees(views, [&](const Eigen::Vector2d& pixel) { return best->direction(pixel); });
  return best;
}

}  // namespace kinecal
