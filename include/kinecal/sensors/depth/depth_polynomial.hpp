// How a depth camera bends what it measures: a factor of depth that depends on depth and pixel.
//
//   g = 1 + z_quadratic z1 + z_x x + z_y y + z_xx x^2 + z_xy x y + z_yy y^2      z' = z1 g
//
// z1 is the depth with offset and scale.  x = X/Z, y = Y/Z are those of the recorded pixel, with the recorded
// intrinsics: a change of fx or cx does not move the polynomial.  Depth by triangulation, z = f b / disparity, is off
// by z^2 / (f b) per pixel of disparity: that is z_quadratic.  A tilted sensor gives z_x and z_y, a lens that is not
// that of the driver the others.  The order 1, x, x^2 is of size 1, 0.5, 0.25 inside the image, so normal equations are
// well scaled.
//
// Weakly determined together: z_offset, z_scaling and z_quadratic, unless features are at three or more depths that
// differ by half; z_x with cx and the camera's rotation about y, z_y with cy and the one about x, unless features
// reach the edges of the image (these differ by x^2 only); z_xx + z_yy with z_scaling for features near the center.
// Source: Khoshelham, Oude Elberink (2012), Accuracy and resolution of Kinect depth data: z^2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "kinecal/parameters/parameter.hpp"

namespace kinecal {

/// The coefficients of the factor of depth, in this order.
inline constexpr std::array kDepthPolynomial = {ParameterInfo{"z_quadratic", "1/m"},
                                                ParameterInfo{"z_x"},
                                                ParameterInfo{"z_y"},
                                                ParameterInfo{"z_xx"},
                                                ParameterInfo{"z_xy"},
                                                ParameterInfo{"z_yy"}};
/// Number of them.
inline constexpr std::size_t kDepthTerms = kDepthPolynomial.size();

/// What each coefficient is multiplied by.
/// @param z     depth with offset and scale, metres
/// @param x, y  of the recorded pixel, in focal lengths
template <class S>
[[nodiscard]] std::array<S, kDepthTerms> depth_terms(const S& z, const S& x, const S& y) {
  return {z, x, y, x * x, x * y, y * y};
}

/// The factor of depth.
/// @param c  (6) coefficients
template <class S, class Q, class Coefficients>
[[nodiscard]] S depth_factor(const S& z, const Q& x, const Q& y, const Coefficients& c) {
  return 1.0 + c[0] * z + c[1] * x + c[2] * y + c[3] * (x * x) + c[4] * (x * y) + c[5] * (y * y);
}

}  // namespace kinecal
