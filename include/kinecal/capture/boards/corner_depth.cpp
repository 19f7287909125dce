// Definitions of corner_depth.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/corner_depth.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "kinecal/geometry/median.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A point of the cloud near a corner: its pixel from the corner, and x/z, y/z, 1/z.
struct PointNearCorner {
  Vector3<double> place;  ///< (1, du, dv)
  Vector3<double> value;
};

/// The valid points near a corner.
[[nodiscard]] std::vector<PointNearCorner> points_near_corner(const PointCloud& points,
                                                              const Eigen::Vector2d& pixel,
                                                              double reach, int& places) {
  std::vector<PointNearCorner> near;
  places = 0;
  for (int v = static_cast<int>(std::ceil(pixel.y() - reach)); v <= pixel.y() + reach; ++v) {
    for (int u = static_cast<int>(std::ceil(pixel.x() - reach)); u <= pixel.x() + reach; ++u) {
      ++places;
      if (!points.contains(u, v)) continue;
      const Vector3<double> p = points(u, v).cast<double>();
      if (!p.allFinite() || !(p.z() > 0.0)) continue;
      near.push_back(
          {{1.0, u - pixel.x(), v - pixel.y()}, {p.x() / p.z(), p.y() / p.z(), 1.0 / p.z()}});
    }
  }
  return near;
}

/// Columns: the value at the corner and its slopes, of x/z, y/z and 1/z.  nullopt if the corner is
/// further from the points than they are from each other.
[[nodiscard]] std::optional<Matrix3<double>> corner_lines(
    const std::vector<PointNearCorner>& near) {
  Matrix3<double> normal = Matrix3<double>::Zero(), right = Matrix3<double>::Zero();
  for (const PointNearCorner& p : near) {
    normal += p.place * p.place.transpose();
    right += p.place * p.value.transpose();
  }
  const Eigen::LDLT<Matrix3<double>> factors(normal);
  if (near.size() < 4 || !(factors.vectorD().minCoeff() > 1e-6)) return std::nullopt;
  // Variance at the corner, relative to that of one point.  With n points all around it, it is 1/n.
  const double variance = factors.solve(Vector3<double>::UnitX()).x();
  if (variance > 4.0 / static_cast<double>(near.size())) return std::nullopt;
  return Matrix3<double>(factors.solve(right));
}

/// Median distance of points from a plane of 1/z.
[[nodiscard]] double median_error(const std::vector<PointNearCorner>& near,
                                  const Vector3<double>& depth) {
  std::vector<double> errors;
  errors.reserve(near.size());
  for (const auto& p : near) errors.push_back(std::abs(p.place.dot(depth) - p.value.z()));
  return median_of(std::move(errors));
}

/// The plane of 1/z through three of the points with the least median error.
/// Source: Rousseeuw, Least Median of Squares Regression, 1984.
[[nodiscard]] Vector3<double> median_plane(const std::vector<PointNearCorner>& near) {
  constexpr int kTrials = 24;  // one in 10^5 fails with a quarter of the points off the plane
  std::mt19937 random(1);
  Vector3<double> best = Vector3<double>::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < kTrials; ++trial) {
    Matrix3<double> places;
    Vector3<double> values;
    for (int k = 0; k < 3; ++k) {
      const PointNearCorner& p = near[random() % near.size()];
      places.row(k) = p.place.transpose();
      values(k) = p.value.z();
    }
    if (!(std::abs(places.determinant()) > 0.5)) continue;
    const Vector3<double> depth = places.inverse() * values;
    const double error = median_error(near, depth);
    if (error < least) {
      least = error;
      best = depth;
    }
  }
  return best;
}

}  // namespace
}  // namespace detail

std::optional<Vector3<double>> point_at(const PointCloud& points, const Eigen::Vector2d& pixel,
                                        double reach) {
  int places = 0;
  std::vector<detail::PointNearCorner> near =
      detail::points_near_corner(points, pixel, std::max(reach, 1.0), places);
  const std::size_t enough = static_cast<std::size_t>(places + 1) / 2;
  if (near.size() < enough) return std::nullopt;
  const Vector3<double> depth = detail::median_plane(near);
  const double limit = 5.0 * detail::median_error(near, depth) + 1e-9;
  std::erase_if(near, [&](const detail::PointNearCorner& p) {
    return std::abs(p.place.dot(depth) - p.value.z()) > limit;
  });
  if (near.size() < enough) return std::nullopt;
  const auto lines = detail::corner_lines(near);
  if (!lines) return std::nullopt;
  const Vector3<double> at = lines->row(0).transpose();
  if (!(at.z() > 0.0)) return std::nullopt;
  return Vector3<double>(at.x() / at.z(), at.y() / at.z(), 1.0 / at.z());
}

}  // namespace kinecal
