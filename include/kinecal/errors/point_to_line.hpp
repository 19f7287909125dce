// Distance of a point to a known line (point_to_line): a laser beam, an edge, a taut wire.
//
//   r = ( u . (p - q),  v . (p - q) )
//
// with a point q of the line and unit vectors u, v perpendicular to it and to each other.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to a known line.
class PointToLine {
 public:
  static constexpr const char* kType = "point_to_line";  ///< name in configurations
  static constexpr const char* kUnit = "m";              ///< of the residual

  /// The line x = y = 0.
  PointToLine() : PointToLine({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}) {}
  /// @param point      (3) of the line, metres, in the base
  /// @param direction  (3) of the line, of any length, in the base
  /// @throws std::invalid_argument  if the direction is zero
  PointToLine(const Vector3<double>& point, const Vector3<double>& direction) : point_(point) {
    const Vector3<double> unit = direction.stableNormalized();
    if (!(unit.norm() > 0.0))
      throw std::invalid_argument("the line's direction (a, b, c) has length zero");
    int least = 0;
    unit.cwiseAbs().minCoeff(&least);
    u_ = cross<double>(unit, Vector3<double>::Unit(least)).normalized();
    v_ = cross<double>(unit, u_).normalized();
  }

  /// The distance of a point, in two directions.
  /// @param p_base  (3) metres, in the base
  /// @returns       (2) metres
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const Vector3<S>& p_base) const {
    const S x = p_base.x() - point_.x(), y = p_base.y() - point_.y(), z = p_base.z() - point_.z();
    return {u_.x() * x + u_.y() * y + u_.z() * z, v_.x() * x + v_.y() * y + v_.z() * z};
  }

 private:
  Vector3<double> point_, u_, v_;
};

}  // namespace kinecal
