// A lens of a user's own: the division model with one coefficient, and no sight(), which is found.
// Source: Fitzgibbon, Simultaneous Linear Estimation of Multiple View Geometry and Lens Distortion, 2001.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal::test {

/// (x, y, z) = (x', y', 1 + k r'^2) up to scale
struct Division {
  static constexpr std::string_view kName = "division";
  static constexpr std::array kCoefficients = {ParameterInfo{"k"}};

  template <class S, class C>
  static Eigen::Matrix<S, 2, 1> image(const Vector3<S>& p, const std::array<C, 1>& d) {
    using std::sqrt;
    const S x = p.x() / p.z(), y = p.y() / p.z();
    const S scale = 2.0 / (1.0 + sqrt(S(1.0 - 4.0 * d[0] * (x * x + y * y))));
    return {x * scale, y * scale};
  }
  /// Up to 45 degrees, where image() is defined for k below 1/4.
  template <class S>
  static auto sees(const Vector3<S>& p) {
    using std::sqrt;
    return p.z() > sqrt(S(p.x() * p.x() + p.y() * p.y()));
  }
};
static_assert(LensModel<Division> && Sensor<LensCamera<Division>>);

}  // namespace kinecal::test
