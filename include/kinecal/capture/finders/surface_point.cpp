// Definitions of surface_point.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/surface_point.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace kinecal {
namespace detail {
namespace {

/// A point near the place: its position, distance and weight.
struct NearPoint {
  double u, v;  ///< pixels from the place
  double z;     ///< metres
  double weight;
};

/// Valid points of a window, nearest to the camera first.
std::vector<NearPoint> points_around(const PointCloud& cloud, double u, double v, int radius) {
  std::vector<NearPoint> points;
  const auto column = static_cast<int>(std::lround(u)), row = static_cast<int>(std::lround(v));
  for (int y = std::max(0, row - radius); y <= std::min(cloud.height - 1, row + radius); ++y) {
    for (int x = std::max(0, column - radius); x <= std::min(cloud.width - 1, column + radius);
         ++x) {
      const float z = cloud(x, y).z();
      if (!std::isfinite(z) || !(z > 0.0F)) continue;
      const double du = x - u, dv = y - v;
      points.push_back({du, dv, static_cast<double>(z), 1.0 / (1.0 + du * du + dv * dv)});
    }
  }
  std::sort(points.begin(), points.end(),
            [](const NearPoint& a, const NearPoint& b) { return a.z < b.z; });
  return points;
}

/// The surface at the place.
/// @param points  nearest to the camera first
std::span<const NearPoint> surface_at(std::span<const NearPoint> points) {
  constexpr double kGap = 0.01, kLeastGap = 0.005;  // of the depth; metres
  constexpr double kNearSide = 0.4;                 // of the weight
  struct Surface {
    std::span<const NearPoint> points;
    double weight;
  };
  std::vector<Surface> surfaces;
  std::size_t first = 0;
  double weight = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    weight += points[i].weight;
    const bool last = i + 1 == points.size() ||
                      points[i + 1].z - points[i].z > std::max(kLeastGap, kGap * points[i].z);
    if (!last) continue;
    surfaces.push_back({points.subspan(first, i + 1 - first), weight});
    first = i + 1;
    weight = 0.0;
  }
  double most = 0.0;
  for (const Surface& surface : surfaces) most = std::max(most, surface.weight);
  for (const Surface& surface : surfaces) {
    if (surface.weight >= kNearSide * most) return surface.points;
  }
  return {};
}

/// Depth of a surface at the place, metres.
/// @param points  at least one, nearest to the camera first
double depth_at_place(std::span<const NearPoint> points) {
  double w = 0.0, u = 0.0, v = 0.0, d = 0.0;
  for (const NearPoint& p : points) {
    w += p.weight;
    u += p.weight * p.u;
    v += p.weight * p.v;
    d += p.weight / p.z;
  }
  u /= w;
  v /= w;
  d /= w;
  double uu = 0.0, uv = 0.0, vv = 0.0, ud = 0.0, vd = 0.0;
  for (const NearPoint& p : points) {
    const double a = p.u - u, b = p.v - v, c = 1.0 / p.z - d;
    uu += p.weight / w * a * a;
    uv += p.weight / w * a * b;
    vv += p.weight / w * b * b;
    ud += p.weight / w * a * c;
    vd += p.weight / w * b * c;
  }
  constexpr double kLeastSpread = 0.25;  // pixels^4: points on one line do not give a slope
  const double determinant = uu * vv - uv * uv;
  double inverse = d;
  if (determinant > kLeastSpread) {
    inverse += -u * (vv * ud - uv * vd) / determinant - v * (uu * vd - uv * ud) / determinant;
  }
  return 1.0 / std::clamp(inverse, 1.0 / points.back().z, 1.0 / points.front().z);
}

}  // namespace
}  // namespace detail

std::optional<Vector3<double>> surface_point(const View& view, double u, double v, int radius) {
  constexpr std::size_t kEnough = 12, kLeast = 6;
  const bool inside = u > -1.0 && v > -1.0 && u < view.points.width && v < view.points.height;
  if (!view.camera || !inside) return std::nullopt;
  std::vector<detail::NearPoint> points;
  std::span<const detail::NearPoint> surface;
  for (int r = std::min(2, radius); r <= radius && surface.size() < kEnough; r += 2) {
    points = detail::points_around(view.points, u, v, r);
    surface = detail::surface_at(points);
  }
  if (surface.size() < kLeast) return std::nullopt;
  const double z = detail::depth_at_place(surface);
  const auto& p = view.camera->p;
  return Vector3<double>((u - p[2]) * z / p[0], (v - p[6]) * z / p[5], z);
}

}  // namespace kinecal
