// Whether a flat target was held parallel to itself in all views of a camera.
//
// Such views leave the focal length open: a target twice as far in front of a lens twice as long gives the same pixels.
// Of tilts that come from noise, or from a lens that is not quite right, a fit makes a focal length with a small +-.  So the
// tilts are held against their own +-, and against two degrees: below, foreshortening is less than a thousandth.
// Source: Zhang, A Flexible New Technique for Camera Calibration, 2000, section 4.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/camera_features.ipp"
#include "kinecal/trust/projection_derivatives.ipp"

namespace kinecal::detail {

/// A flat target in the camera's frame.
struct TargetPlane {
  Vector3<double> normal;      ///< (3) unit, away from the camera
  Matrix3<double> covariance;  ///< (3 x 3) of its rotation, square radians
};

/// The plane of the features [first, end) of a camera; nullopt if they are not of a flat target.
/// @param noise  of a pixel coordinate, pixels
[[nodiscard]] inline std::optional<TargetPlane> target_plane(const SolvedProjection& camera,
                                                             const SeenByCamera& seen,
                                                             std::size_t first, std::size_t end,
                                                             double noise) {
  constexpr double kFlat = 1e-3;  // of the variance along the shorter side
  if (end - first < 4) return std::nullopt;
  Vector3<double> mean = Vector3<double>::Zero();
  Matrix3<double> squares = Matrix3<double>::Zero();
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t i = first; i < end; ++i) {
    if (!(seen.distances[i] > 0.0)) return std::nullopt;
    const Vector3<double> p = seen.distances[i] * camera.direction(seen.pixels[i]);
    const auto by_motion = SolvedProjection::by_motion(camera.by_point(p), p, 1.0);
    if (!by_motion.allFinite()) return std::nullopt;
    mean += p;
    squares += p * p.transpose();
    information += by_motion.transpose() * by_motion;
  }
  const auto count = static_cast<double>(end - first);
  mean /= count;
  const Eigenpairs axes = eigenpairs(squares / count - mean * mean.transpose());
  if (!(axes.values(0) < kFlat * axes.values(1))) return std::nullopt;
  const Vector3<double> normal = axes.vectors.col(0);
  return TargetPlane{
      normal.dot(mean) < 0.0 ? Vector3<double>(-normal) : normal,
      noise * noise * Spectrum(information).pseudo_inverse().bottomRightCorner<3, 3>()};
}

/// True if the planes of all views are parallel within twice what noise does, or within two degrees.
/// @param noise  of a pixel coordinate, pixels
[[nodiscard]] inline bool views_are_parallel(const SolvedProjection& camera,
                                             const SeenByCamera& seen, double noise) {
  constexpr double kByNoise = 4.0;  // of squares
  constexpr double kSmall = 2.0 * std::numbers::pi / 180.0;
  std::vector<TargetPlane> planes;
  Vector3<double> sum = Vector3<double>::Zero();
  std::size_t first = 0;
  for (const std::size_t end : seen.ends) {
    const std::optional<TargetPlane> plane = target_plane(camera, seen, first, end, noise);
    if (!plane) return false;
    planes.push_back(*plane);
    sum += plane->normal;
    first = end;
  }
  if (planes.size() < 2) return false;
  const Vector3<double> mean = sum.normalized();
  const Vector3<double> across = mean.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> tilts;
  tilts << across, mean.cross(across);
  double squares = 0.0, by_noise = 0.0;
  for (const TargetPlane& plane : planes) {
    const Eigen::Vector2d tilt = tilts.transpose() * mean.cross(plane.normal);
    const Eigen::Matrix2d variance = tilts.transpose() * plane.covariance * tilts;
    squares += tilt.squaredNorm();
    by_noise += tilt.dot(variance.inverse() * tilt);
  }
  const double freedom = 2.0 * static_cast<double>(planes.size() - 1);
  return squares < kSmall * kSmall * freedom || by_noise < kByNoise * freedom;
}

}  // namespace kinecal::detail
