// The concept of a lens: where the ray through a point meets the image, and back.
//
// A lens is a struct of functions that are templates of the scalar; lens_camera.hpp makes a camera of
// it, whose parameters are its coefficients:
//
//   struct Equidistant {
//     static constexpr std::string_view kName = "equidistant";  // distortion_model of camera_info, `lens:` of a model
//     static constexpr std::array kCoefficients = {ParameterInfo{"k1"}, ...};  // in the order of D
//     image(p, d)      (2) place of the image of a point, in focal lengths from the principal point; not a
//                      number where the lens does not see the point
//     sight(at, d)     what is seen at a place: the inverse of image()
//     sees(p)          (optional) false where image() gives a place, but the lens does not see the point
//   };
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <limits>
#include <string_view>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/parameters/parameter.hpp"

namespace kinecal {

/// What a lens shows at a place of its image.
template <class S>
struct Sight {
  Vector3<S> direction;  ///< (3) of any length, in the optical frame
  Vector3<S> by_x;       ///< (3) change of the direction by the place, in focal lengths
  Vector3<S> by_y;       ///< (3) as above
};

/// A lens.
template <class L>
concept LensModel = requires(const Vector3<double>& p, const Eigen::Matrix<double, 2, 1>& at,
                             const std::array<double, L::kCoefficients.size()>& d) {
  { L::kName } -> std::convertible_to<std::string_view>;
  { L::image(p, d) } -> std::same_as<Eigen::Matrix<double, 2, 1>>;
  { L::sight(at, d) } -> std::same_as<Sight<double>>;
};

namespace detail {

inline constexpr int kMostNewtonSteps = 50;        ///< to invert a lens
inline constexpr double kSmallNewtonStep = 1e-14;  ///< after which it is inverted

/// True if the coefficients of all lanes are zero and do not change.
template <class C, std::size_t N>
[[nodiscard]] bool are_zero(const std::array<C, N>& d) {
  if constexpr (std::same_as<ValueOf<C>, C>) {
    for (const C& coefficient : d) {
      for (int i = 0; i < kLanes<C>; ++i) {
        if (lane(coefficient, i) != 0.0) return false;
      }
    }
    return true;
  } else {
    return false;  // jets: their derivatives matter
  }
}

/// Values of coefficients.
template <class C, std::size_t N>
[[nodiscard]] std::array<ValueOf<C>, N> values_of(const std::array<C, N>& d) {
  std::array<ValueOf<C>, N> values;
  for (std::size_t i = 0; i < N; ++i) values[i] = value_of(d[i]);
  return values;
}

/// Zero where a < b, else not a number; lane by lane.
template <class Q>
[[nodiscard]] Q zero_if_less(const Q& a, const Q& b) {
  return select(a < b, Q(0.0), Q(std::numeric_limits<double>::quiet_NaN()));
}

/// True if x > limit * scale in a lane.
template <class Q>
[[nodiscard]] bool any_above(double limit, const Q& x, const Q& scale) {
  for (int i = 0; i < kLanes<Q>; ++i) {
    if (lane(x, i) > limit * lane(scale, i)) return true;
  }
  return false;
}

}  // namespace detail

}  // namespace kinecal
