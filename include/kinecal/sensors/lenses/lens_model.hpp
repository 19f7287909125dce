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
//     sight(at, d)     (optional) what is seen at a place: the inverse of image(), else found by Newton's method
//     sees(p)          (optional) false where image() gives a place, but the lens does not see the point
//     kAlso            (optional) an array of other names that files give it
//     kBendsPinhole    (optional) true if it contains the lenses with fewer coefficients for which this is true
//   };
//
// image() is called with jets of jets where sight() is absent, so it must not branch on values: select().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
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
concept LensModel = requires(const Vector3<double>& p,
                             const std::array<double, L::kCoefficients.size()>& d) {
  { L::kName } -> std::convertible_to<std::string_view>;
  { L::image(p, d) } -> std::same_as<Eigen::Matrix<double, 2, 1>>;
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

/// A lens near a direction: the places of its images, and the inverse of how they change.
template <LensModel L, class S>
struct LensNear {
  Eigen::Matrix<S, 2, 1> at;       ///< image of the direction
  Eigen::Matrix<S, 2, 2> inverse;  ///< move along the two axes for a move of the image by one

  /// @param axes  (3 x 2) along which the direction moves
  template <class C, std::size_t N>
  LensNear(const Vector3<S>& direction, const Eigen::Matrix<S, 3, 2>& axes,
           const std::array<C, N>& d) {
    using J = Jet<S, 2>;
    Vector3<J> moved;
    for (int i = 0; i < 3; ++i) moved(i) = J(direction(i), {axes(i, 0), axes(i, 1)});
    const Eigen::Matrix<J, 2, 1> seen = L::image(moved, d);
    const S a = seen(0).v(0), b = seen(0).v(1), c = seen(1).v(0), e = seen(1).v(1);
    const S scale = 1.0 / S(a * e - b * c);
    at = {seen(0).a, seen(1).a};
    inverse << e * scale, -(b * scale), -(c * scale), a * scale;
  }
  /// The move along the axes that brings the image to a place.
  [[nodiscard]] Eigen::Matrix<S, 2, 1> move_to(const Eigen::Matrix<S, 2, 1>& to) const {
    const S x = to.x() - at.x(), y = to.y() - at.y();
    return {inverse(0, 0) * x + inverse(0, 1) * y, inverse(1, 0) * x + inverse(1, 1) * y};
  }
};

/// The vector with length one.
template <class S>
[[nodiscard]] Vector3<S> unit(const Vector3<S>& v) {
  using std::sqrt;
  const S length = sqrt(S(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
  return {v.x() / length, v.y() / length, v.z() / length};
}

/// (3 x 2) unit vectors across a unit vector, which does not point straight backwards.
template <class Q>
[[nodiscard]] Eigen::Matrix<Q, 3, 2> across(const Vector3<Q>& u) {
  const Q x = u.x() / (1.0 + u.z()), y = u.y() / (1.0 + u.z());
  Eigen::Matrix<Q, 3, 2> axes;
  axes << 1.0 - x * u.x(), -(x * u.y()), -(x * u.y()), 1.0 - y * u.y(), -u.x(), -u.y();
  return axes;
}

/// The unit vector that a lens images at a place, by Newton's method with steps that are halved where they fail.
template <LensModel L, class Q, std::size_t N>
[[nodiscard]] Vector3<Q> direction_at(const Eigen::Matrix<Q, 2, 1>& at, const std::array<Q, N>& d) {
  using std::abs, std::cos, std::sin, std::sqrt;
  const auto miss = [&](const Vector3<Q>& u) {  // no number: infinitely far
    const Eigen::Matrix<Q, 2, 1> seen = L::image(u, d);
    const Q far = abs(Q(seen.x() - at.x())) + abs(Q(seen.y() - at.y()));
    return Q(select(far < Q(HUGE_VAL), far, Q(HUGE_VAL)));
  };
  // It starts as a pinhole, or as an equidistant lens where that is nearer.
  const Q angle = sqrt(Q(at.x() * at.x() + at.y() * at.y()));
  const auto near_axis = angle < Q(1e-6);
  const Q scale = select(near_axis, Q(1.0), Q(sin(angle) / select(near_axis, Q(1.0), angle)));
  const Vector3<Q> equidistant = unit<Q>({scale * at.x(), scale * at.y(), Q(cos(angle))});
  Vector3<Q> u = unit<Q>({at.x(), at.y(), Q(1.0)});
  Q left = miss(u), step(1.0);
  const auto take = [&](const Vector3<Q>& other) {  // where it is nearer
    const Q of_other = miss(other);
    const auto better = of_other < left;
    for (int i = 0; i < 3; ++i) u(i) = select(better, other(i), u(i));
    left = select(better, of_other, left);
    return better;
  };
  (void)take(equidistant);
  bool moves = true;
  for (int n = 0; n < kMostNewtonSteps && moves; ++n) {
    const Eigen::Matrix<Q, 3, 2> axes = across(u);
    const Eigen::Matrix<Q, 2, 1> move = LensNear<L, Q>(u, axes, d).move_to(at);
    Vector3<Q> next;
    for (int i = 0; i < 3; ++i) {
      next(i) = u(i) + step * (axes(i, 0) * move.x() + axes(i, 1) * move.y());
    }
    const auto better = take(unit(next));
    step = select(better, Q(1.0), Q(step * 0.25));
    moves = any_above(kSmallNewtonStep, Q(step * (abs(move.x()) + abs(move.y()))), Q(1.0));
  }
  const Q lost = zero_if_less(left, Q(1e-9 * (1.0 + angle)));
  return {u.x() + lost, u.y() + lost, u.z() + lost};
}

/// What a lens shows at a place of its image: L::sight(), else by Newton's method, whose last step is in S, so that
/// the derivatives are exact.
template <LensModel L, class S, class C, std::size_t N>
[[nodiscard]] Sight<S> sight_of(const Eigen::Matrix<S, 2, 1>& at, const std::array<C, N>& d) {
  if constexpr (requires { L::sight(at, d); }) {
    return L::sight(at, d);
  } else {
    using Q = ValueOf<S>;
    const Vector3<Q> known =
        direction_at<L>(Eigen::Matrix<Q, 2, 1>(value_of(at.x()), value_of(at.y())), values_of(d));
    const Eigen::Matrix<S, 3, 2> fixed = across(known).template cast<S>();
    const Vector3<S> near = known.template cast<S>();
    const auto move = LensNear<L, S>(near, fixed, d).move_to(at);
    Vector3<S> direction;
    for (int i = 0; i < 3; ++i) {
      direction(i) = near(i) + fixed(i, 0) * move.x() + fixed(i, 1) * move.y();
    }
    direction = unit(direction);
    const Eigen::Matrix<S, 3, 2> axes = across(direction);
    const Eigen::Matrix<S, 2, 2> moves = LensNear<L, S>(direction, axes, d).inverse;
    Sight<S> sight{direction, {}, {}};
    for (int i = 0; i < 3; ++i) {
      sight.by_x(i) = axes(i, 0) * moves(0, 0) + axes(i, 1) * moves(1, 0);
      sight.by_y(i) = axes(i, 0) * moves(0, 1) + axes(i, 1) * moves(1, 1);
    }
    return sight;
  }
}

}  // namespace detail

}  // namespace kinecal
