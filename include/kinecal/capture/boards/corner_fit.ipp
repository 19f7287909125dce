// Fits a homography and a lens to the corners of a view, for board_fit.cpp and disc_centres.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal::detail {

inline constexpr double kSharpCorner = 0.15;              // what a good finder achieves, pixels
inline constexpr std::size_t kFewest = 8, kForLens = 12;  // corners

/// Maps pixels to those of a camera without distortion, and back.
struct Straightening {
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> straight, bent;
};

[[nodiscard]] inline Straightening no_lens() {
  const auto same = [](const Eigen::Vector2d& pixel) { return pixel; };
  return {same, same};
}

/// A fit: pixel = lens(H (x, y, 1)), and the distance of each corner.
struct CornerFit {
  Straightening lens = no_lens();
  Matrix3<double> h = Matrix3<double>::Identity();  ///< (3 x 3)
  std::vector<Eigen::Vector2d> misses;              ///< seen minus predicted, pixels
  std::vector<double> weights;                      ///< from 0 to 1
  double typical = std::numeric_limits<double>::infinity();
};

/// Distances, their median, and weights of the next pass.
inline void weigh(CornerFit& fit) {
  std::vector<double> off;
  for (const Eigen::Vector2d& miss : fit.misses) {
    off.push_back(miss.allFinite() ? miss.norm() : std::numeric_limits<double>::infinity());
  }
  fit.typical = off.empty() ? 0.0 : median_of(off);
  const double reach = 3.0 * std::max(kSharpCorner, fit.typical);
  for (std::size_t i = 0; i < off.size(); ++i) {
    const double ratio = off[i] / reach;
    fit.weights[i] = std::isfinite(ratio) ? 1.0 / std::pow(1.0 + ratio * ratio, 2) : 0.0;
  }
}

/// The corners of a view: on the target and in the image.
struct PlaneView {
  std::vector<Eigen::Vector2d> plane, pixels;

  [[nodiscard]] CornerFit fit(const Straightening& lens) const {
    constexpr int kPasses = 12;
    CornerFit best;
    best.lens = lens;
    best.misses.resize(plane.size());
    best.weights.assign(plane.size(), 1.0);
    std::vector<Eigen::Vector2d> straight;
    for (const Eigen::Vector2d& pixel : pixels) straight.push_back(lens.straight(pixel));
    for (int pass = 0; pass < kPasses; ++pass) {
      const auto h = homography(plane, straight, best.weights);
      if (!h) break;
      best.h = *h;
      for (std::size_t i = 0; i < plane.size(); ++i) {
        best.misses[i] = pixels[i] - lens.bent(mapped(*h, plane[i]));
      }
      weigh(best);
    }
    return best;
  }
};

/// r_u = r / (1 + k r^2), with 1 + k r^2 = share at the radius of the farthest corner.
[[nodiscard]] inline Straightening division_lens(const Eigen::Vector2d& centre, double radius,
                                                 double share) {
  const double k = (share - 1.0) / (radius * radius);
  const auto straight = [=](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
    const Eigen::Vector2d from = pixel - centre;
    return centre + from / (1.0 + k * from.squaredNorm());
  };
  const auto bent = [=](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
    const Eigen::Vector2d from = pixel - centre;
    const double root = 1.0 - 4.0 * k * from.squaredNorm();  // of k r_u r^2 - r + r_u = 0
    return centre + 2.0 / (1.0 + std::sqrt(std::max(0.0, root))) * from;
  };
  return {straight, bent};
}

/// The lens of camera_info; nullopt if it has none, or one that kinecal does not know.  Its pinhole looks at
/// the view: so a view far from the axis of a fisheye is straight, too.
[[nodiscard]] inline std::optional<Straightening> known_lens(const CameraInfo& info,
                                                             const PlaneView& view) {
  if (!is_raw(info, ImageKind::automatic)) return std::nullopt;
  try {
    const Lens lens(info, ImageKind::raw);
    const double focal = lens.focal_length();
    std::vector<Vector3<double>> seen;
    for (const Eigen::Vector2d& pixel : view.pixels) {
      const Vector3<double> ray = lens.ray(pixel.x(), pixel.y());
      if (ray.allFinite()) seen.push_back(ray);
    }
    const Matrix3<double> turn = turn_to_axis(seen);
    return Straightening{[=](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
                           return focal * (turn * lens.ray(pixel.x(), pixel.y())).hnormalized();
                         },
                         [=](const Eigen::Vector2d& p) {
                           return lens.project(turn.transpose() * (p / focal).homogeneous());
                         }};
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// The fit with the best k about the centre of the image.
[[nodiscard]] inline CornerFit best_division(const PlaneView& view, const CameraInfo& camera) {
  const Eigen::Vector2d centre(0.5 * camera.width, 0.5 * camera.height);
  double radius = 1.0;
  for (const Eigen::Vector2d& p : view.pixels) radius = std::max(radius, (p - centre).norm());
  constexpr double kLeast = 0.25, kMost = 1.6;
  double best_share = 1.0, step = 0.09;
  CornerFit best;
  const auto attempt = [&](double share) {
    CornerFit fit = view.fit(division_lens(centre, radius, share));
    if (!(fit.typical < best.typical)) return;
    best = std::move(fit);
    best_share = share;
  };
  for (double share = kLeast; share <= kMost; share += step) attempt(share);
  for (; step > 0.002; step /= 3.0) {
    const double from = best_share;
    for (const int side : {-2, -1, 1, 2}) attempt(from + side * step / 3.0);
  }
  return best;
}

/// The fit with the best focal length of an equidistant fisheye whose axis is at the centre of the image.
/// It fits a board far from the axis, or behind the camera, too, of which no pinhole has an image.
/// @returns  a fit of nothing if the camera has no size
[[nodiscard]] inline CornerFit best_fisheye(const PlaneView& view, const CameraInfo& camera) {
  CameraInfo lens;
  lens.width = camera.width;
  lens.height = camera.height;
  lens.distortion_model = "equidistant";
  lens.d = {0, 0, 0, 0};
  constexpr double kLeast = 0.2, kMost = 1.0;  // focal lengths, of the longer side
  const double longer = std::max(camera.width, camera.height);
  double best_focal = kMost * longer, step = 1.1;
  CornerFit best;
  if (longer == 0.0) return best;  // the size of the image is unknown
  const auto attempt = [&](double focal) {
    lens.k = {focal, 0, 0.5 * camera.width, 0, focal, 0.5 * camera.height, 0, 0, 1};
    const auto known = known_lens(lens, view);
    if (!known) return;
    CornerFit fit = view.fit(*known);
    if (!(fit.typical < best.typical)) return;
    best = std::move(fit);
    best_focal = focal;
  };
  for (double focal = kLeast * longer; focal <= kMost * longer; focal *= step) attempt(focal);
  for (; step > 1.003; step = std::cbrt(step)) {
    const double from = best_focal;
    for (const int side : {-2, -1, 1, 2}) attempt(from * std::pow(step, side / 3.0));
  }
  return best;
}

/// A corner that is farther off is wrong, pixels.  4 medians are 4.7 standard deviations: chance drops none.
[[nodiscard]] inline double limit_of(const CornerFit& fit) {
  constexpr double kPixels = 0.75, kMedians = 4.0;
  return std::max(kPixels, kMedians * fit.typical);
}

[[nodiscard]] inline std::ptrdiff_t wrong_corners(const CornerFit& fit) {
  const double limit = limit_of(fit);
  return std::count_if(fit.misses.begin(), fit.misses.end(),
                       [&](const Eigen::Vector2d& miss) { return !(miss.norm() <= limit); });
}

/// True if a fit leaves nothing that another lens could explain.
[[nodiscard]] inline bool is_good(const CornerFit& fit) {
  constexpr double kGood = 0.25;  // pixels
  return fit.typical <= kGood && wrong_corners(fit) == 0;
}

/// Takes another fit if it is clearly better.
inline void take_better(CornerFit other, CornerFit& best) {
  constexpr double kBetter = 0.6;  // of what was left
  // A lens that is bent more than the model shows first where it is bent most.
  const bool explains = other.typical <= best.typical && wrong_corners(other) < wrong_corners(best);
  if (other.typical < kBetter * best.typical || explains) best = std::move(other);
}

/// The fit with the lens that agrees best: none, that of the camera, the division model or a fisheye.
[[nodiscard]] inline CornerFit best_lens(const PlaneView& view, const CameraInfo& camera) {
  CornerFit best = view.fit(no_lens());
  if (is_good(best)) return best;
  if (const auto lens = known_lens(camera, view)) take_better(view.fit(*lens), best);
  if (is_good(best) || view.plane.size() < kForLens) return best;
  take_better(best_division(view, camera), best);
  if (!is_good(best)) take_better(best_fisheye(view, camera), best);
  return best;
}

}  // namespace kinecal::detail
