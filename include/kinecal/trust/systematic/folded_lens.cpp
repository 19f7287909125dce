// Definitions of folded_lens.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/systematic/folded_lens.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

namespace detail {

bool frees_lens(const MountedSensor& camera, const FreeSet& free) {
  const std::vector<int>& own = camera.parameters();
  return camera.sensor().delivers(Quantity::pixel) && own.size() > kIntrinsics &&
         std::any_of(own.begin() + kIntrinsics, own.end(),
                     [&](int p) { return free.column(p) >= 0; });
}

namespace {

/// A camera at the solution.
struct SolvedCamera {
  const MountedSensor* mounted = nullptr;
  std::vector<double> own, settings;
  Eigen::Vector2d center{0.0, 0.0};

  /// True if the lens images some direction at this pixel, and no other that is nearer to the axis there.
  [[nodiscard]] bool sees(const Eigen::Vector2d& pixel) const {
    return mounted->sensor().place({pixel.x(), pixel.y(), 0.0}, settings, own).allFinite();
  }
  /// The radius at which the lens folds over on the way to a pixel; nullopt if it does not.
  [[nodiscard]] std::optional<double> fold_before(const Eigen::Vector2d& pixel) const {
    if (sees(pixel)) return std::nullopt;
    double inside = 0.0, outside = 1.0;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (inside + outside);
      (sees(center + middle * (pixel - center)) ? inside : outside) = middle;
    }
    return inside * (pixel - center).norm();
  }
};

/// Places at the border of an image, or around its center at a radius.
[[nodiscard]] std::vector<Eigen::Vector2d> border(const CameraInfo& info,
                                                  const Eigen::Vector2d& center, double radius) {
  constexpr int kPlaces = 48;
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < kPlaces; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kPlaces;
    places.push_back(center + radius * Eigen::Vector2d(std::cos(turn), std::sin(turn)));
  }
  if (info.width <= 0 || info.height <= 0) return places;
  places.clear();
  const double w = info.width - 1.0, h = info.height - 1.0;
  for (int i = 0; i <= kPlaces / 4; ++i) {
    const double share = 4.0 * i / kPlaces;
    places.insert(places.end(),
                  {{share * w, 0.0}, {share * w, h}, {0.0, share * h}, {w, share * h}});
  }
  return places;
}

}  // namespace
}  // namespace detail

std::vector<FoldedLens> folded_lenses(const AnyProblem& problem, const FreeSet& free,
                                      ParameterValues values, std::span<const Sample> samples) {
  std::vector<FoldedLens> folded;
  for (const MountedSensor& mounted : problem.sensors()) {
    if (!detail::frees_lens(mounted, free)) continue;
    const std::string& name = mounted.mount().name;
    std::optional<detail::SolvedCamera> camera;
    FoldedLens fold{name};
    const CameraInfo* info = nullptr;
    for (const Sample& sample : samples) {
      const Observation* seen = sample.observation(name);
      if (seen == nullptr || !seen->camera) continue;
      if (!camera) {
        info = &*seen->camera;
        camera = detail::SolvedCamera{&mounted, mounted.own_values(values),
                                      mounted.sensor().settings(*seen)};
        const std::vector<double>&s = camera->settings, &v = camera->own;  // fx fy cx cy, ...
        camera->center = {s[2] * (1.0 + v[2]), s[3] * (1.0 + v[3])};
      }
      for (const Feature& feature : seen->features) {
        if (!feature.point.allFinite()) continue;
        fold.farthest = std::max(fold.farthest, (feature.point.head<2>() - camera->center).norm());
      }
    }
    if (!camera) continue;
    fold.radius = HUGE_VAL;
    for (const Eigen::Vector2d& place : detail::border(*info, camera->center, fold.farthest)) {
      fold.corner = std::max(fold.corner, (place - camera->center).norm());
      fold.radius = std::min(fold.radius, camera->fold_before(place).value_or(HUGE_VAL));
    }
    if (std::isfinite(fold.radius)) folded.push_back(fold);
  }
  return folded;
}

}  // namespace kinecal
