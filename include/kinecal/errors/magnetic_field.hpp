// What a magnetometer reads as it turns in the field of the earth: hard and soft iron (magnetic_field).
//
//   r = (|A (m - b)|^2 - F^2) / (2 F0)        A = 1 + (xx xy xz; xy yy yz; xz yz zz)
//
// m is the reading, b the bias: hard iron, which turns with the sensor.  A undoes soft iron and what the gains of the axes
// differ by.  F is the strength of the field, and F0 where it begins: near the solution, r is |A (m - b)| - F.
// A and F times the same number are zero where they were: hold F where it is known, or zz.  Of a base that turns in place, all
// readings are in a plane: it shows the bias within the plane, and F there.  Squares, because then a bias along the normal
// changes all residuals alike, as F does: nothing runs away along what is not shown.
// A rotation of A is not shown by a strength: the axes of the sensor stay as they are.
// Source: Gebre-Egziabher et al., Calibration of strapdown magnetometers in the magnetic field domain, 2006; with |m - b| - F,
// HardIronOffsetError of robot_calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// The strength of the field that a magnetometer reads, against the one there is.
struct MagneticField {
  static constexpr const char* kType = "magnetic_field";  ///< name in configurations
  static constexpr const char* kUnit = "1";               ///< of the residual: microtesla
  static constexpr std::array kParameters = {
      ParameterInfo{"bias_x", "uT"}, ParameterInfo{"bias_y", "uT"},
      ParameterInfo{"bias_z", "uT"}, ParameterInfo{"xx", "1"},
      ParameterInfo{"yy", "1"},      ParameterInfo{"zz", "1"},
      ParameterInfo{"xy", "1"},      ParameterInfo{"xz", "1"},
      ParameterInfo{"yz", "1"},      ParameterInfo{"field", "uT", 50.0}};
  /// The reading, microtesla.
  static constexpr std::array<std::string_view, 3> kConditions = {"mag_x", "mag_y", "mag_z"};

  std::array<double, kParameters.size()> start = {0.0, 0.0, 0.0, 0.0, 0.0,
                                                  0.0, 0.0, 0.0, 0.0, 50.0};  ///< of the parameters

  /// Initial values of the parameters.
  [[nodiscard]] const std::array<double, kParameters.size()>& initial() const { return start; }

  /// The difference of the strengths.
  /// @param own  bias, microtesla; xx yy zz xy xz yz; field, microtesla
  /// @param m    (3) the reading, microtesla
  /// @returns    (1) microtesla
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const std::array<S, kParameters.size()>& own,
                                                  const std::array<Q, 3>& m) const {
    const Vector3<S> p(m[0] - own[0], m[1] - own[1], m[2] - own[2]);
    const Vector3<S> seen(p.x() + own[3] * p.x() + own[6] * p.y() + own[7] * p.z(),
                          p.y() + own[6] * p.x() + own[4] * p.y() + own[8] * p.z(),
                          p.z() + own[7] * p.x() + own[8] * p.y() + own[5] * p.z());
    return Eigen::Matrix<S, 1, 1>(S((seen.squaredNorm() - own[9] * own[9]) / (2.0 * start.back())));
  }
};

}  // namespace kinecal
