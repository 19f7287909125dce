// A flat board that may be bent a little (board): points in a link, as of chain3d, on a paraboloid.
//
//   z' = z + bend_x (x - x0)^2 / 2 + bend_y (y - y0)^2 / 2
//
// Parameters, in this order: bend_x, bend_y: curvatures, 1 / m; (x0, y0) is the middle of the features of the
// observation.  Printed boards bow by a millimetre or so, which shows in residuals of wide cameras.
// Source: the model of mrcal, whose deflection at the middle of a board of length L is -bend L^2 / 8.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// Points of a board that may be bent.
struct BentBoard {
  static constexpr std::string_view kType = "board";  ///< name in configurations
  static constexpr std::array kParameters = {ParameterInfo{"bend_x", "1/m"},
                                             ParameterInfo{"bend_y", "1/m"}};
  static constexpr std::size_t kSettings = 2;  ///< x0 y0, metres

  /// The middle of the features.
  [[nodiscard]] static std::array<double, 2> settings(const Observation& seen) {
    Eigen::AlignedBox2d box;
    for (const Feature& feature : seen.features) {
      if (feature.point.allFinite()) box.extend(Eigen::Vector2d(feature.point.head<2>()));
    }
    if (box.isEmpty()) return {0.0, 0.0};
    return {box.center().x(), box.center().y()};
  }
  /// The point of the bent board.
  /// @param v  (2) parameters in the order above
  /// @returns  (3) metres, in the frame of the feature
  template <class S, class Q>
  [[nodiscard]] Vector3<S> place(const Measurement<BentBoard, Q>& m,
                                 const std::array<S, 2>& v) const {
    const Q x = m.point.x() - m.settings[0], y = m.point.y() - m.settings[1];
    return {S(m.point.x()), S(m.point.y()),
            m.point.z() + 0.5 * (v[0] * Q(x * x)) + 0.5 * (v[1] * Q(y * y))};
  }
};

}  // namespace kinecal
