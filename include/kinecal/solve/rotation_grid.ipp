// An even grid of rotations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "kinecal/solve/rotation_grid.hpp"

namespace kinecal {

KINECAL_INLINE Vector3<double> grid_rotation(int index, int count, int axes) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double s = index + 0.5, t = s / count;
  if (axes == 1) return {kTurn * (t - 0.5), 0.0, 0.0};
  if (axes == 2) {  // a sunflower
    const double radius = std::numbers::pi * std::sqrt(t), angle = kTurn * s / std::numbers::phi;
    return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
  }
  constexpr double kPsi = 1.533751168755204288118041;
  const double a = kTurn * s / std::numbers::sqrt2, b = kTurn * s / kPsi;
  const double r = std::sqrt(t), rest = std::sqrt(1.0 - t);
  const Eigen::AngleAxisd rotation(
      Eigen::Quaterniond(rest * std::cos(b), r * std::sin(a), r * std::cos(a), rest * std::sin(b)));
  return shortest(rotation.angle() * rotation.axis());
}

KINECAL_INLINE Vector3<double> shortest(const Vector3<double>& vector) {
  const double angle = vector.norm();
  if (angle <= std::numbers::pi) return vector;
  return std::remainder(angle, 2.0 * std::numbers::pi) / angle * vector;
}

}  // namespace kinecal
