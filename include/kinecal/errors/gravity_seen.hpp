// Gravity as an accelerometer at rest reads it, on a link that turns (gravity_seen).
//
//   r = R (ax, ay, az) - G
//
// R turns the accelerometer's axes into the base: the pose of a feature of a chain6d sensor.  G is what it would read with
// the axes of the base, (0, 0, 9.80665) if z points up: parameters of the block, <block>_x _y _z.  Free, they allow for a
// base that is not level and for a scale that is not 1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// What an accelerometer at rest reads, less gravity.
struct GravitySeen {
  static constexpr const char* kType = "gravity_seen";  ///< name in configurations
  static constexpr const char* kUnit = "1";             ///< of the residual: m/s^2
  static constexpr std::array kParameters = {ParameterInfo{"x", "m/s^2"},
                                             ParameterInfo{"y", "m/s^2"},
                                             ParameterInfo{"z", "m/s^2", 9.80665}};
  /// The reading, m/s^2 or whatever G is in.
  static constexpr std::array<std::string_view, 3> kConditions = {"ax", "ay", "az"};

  Vector3<double> gravity{0.0, 0.0, 9.80665};  ///< (3) G, m/s^2

  /// Initial values of the parameters.
  [[nodiscard]] std::array<double, 3> initial() const {
    return {gravity.x(), gravity.y(), gravity.z()};
  }

  /// The difference.
  /// @param at       the accelerometer, in the base
  /// @param own      (3) G
  /// @param a        ax ay az
  /// @returns        (3) in the axes of the base
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 3, 1> operator()(const Pose<S>& at, const std::array<S, 3>& own,
                                                  const std::array<Q, 3>& a) const {
    Eigen::Matrix<S, 3, 1> r;
    for (int i = 0; i < 3; ++i) {
      r(i) = at.rotation(i, 0) * a[0] + at.rotation(i, 1) * a[1] + at.rotation(i, 2) * a[2] -
             own[static_cast<std::size_t>(i)];
    }
    return r;
  }
};

}  // namespace kinecal
