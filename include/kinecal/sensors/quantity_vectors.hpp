// What sensors deliver, as vectors of three numbers: transformed to the base, differentiated by
// jets, moved by twists.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>

#include "kinecal/sensors/quantity.hpp"

namespace kinecal {

namespace detail {

/// How a vector of three numbers changes when its body moves by a twist (v, w).
enum class Change {
  point,      ///< as a point p: v + w x p
  direction,  ///< as a direction d: w x d
  rotation,   ///< a rotation: w
  number      ///< not a spatial quantity
};

/// The vector in S; takes the values of jets over S.
template <class S, class J>
[[nodiscard]] Vector3<S> in_scalar(const Vector3<J>& v) {
  if constexpr (std::same_as<S, J>) {
    return v;
  } else {
    return values_of(v);
  }
}

/// A quantity as vectors of three numbers each: values, and variables for jets.
template <Quantity Q>
struct VectorsOf;

template <>
struct VectorsOf<Quantity::point> {
  template <class S>
  using Type = Vector3<S>;
  static constexpr std::array kVariables = {Change::point};
  static constexpr std::size_t kValues = 1;

  /// Transforms to the base.
  template <class S, class J>
  static void to_base(const Pose<S>& frame, const Vector3<J>& p, Vector3<S>* out) {
    out[0] = frame * in_scalar<S>(p);
  }
  /// Changes of the variables per unit of the k-th variable of a jet in the frame.
  template <class S, class J>
  static void change(const Pose<S>& frame, const Vector3<J>& p, int k, Vector3<S>* out) {
    out[0] = rotated(frame.rotation, Vector3<S>(p.x().v(k), p.y().v(k), p.z().v(k)));
  }
  template <class J, class S>
  static Vector3<J> jets(const Vector3<S>* values, int first) {
    return point_jets<J>(values[0], first);
  }
  template <class S>
  static Vector3<S> plain(const Vector3<S>* values) {
    return values[0];
  }
};

template <>
struct VectorsOf<Quantity::ray> {
  template <class S>
  using Type = Ray<S>;
  static constexpr std::array kVariables = {Change::point, Change::direction, Change::direction,
                                            Change::direction};
  static constexpr std::size_t kValues = 4;

  template <class S, class J>
  static void to_base(const Pose<S>& frame, const Ray<J>& ray, Vector3<S>* out) {
    out[0] = frame * in_scalar<S>(ray.origin);
    out[1] = rotated(frame.rotation, in_scalar<S>(ray.direction));
    out[2] = rotated(frame.rotation, in_scalar<S>(ray.by_u));
    out[3] = rotated(frame.rotation, in_scalar<S>(ray.by_v));
  }
  template <class S, class J>
  static void change(const Pose<S>& frame, const Ray<J>& ray, int k, Vector3<S>* out) {
    using Point = VectorsOf<Quantity::point>;
    Point::change(frame, ray.origin, k, out);
    Point::change(frame, ray.direction, k, out + 1);
    Point::change(frame, ray.by_u, k, out + 2);
    Point::change(frame, ray.by_v, k, out + 3);
  }
  template <class J, class S>
  static Ray<J> jets(const Vector3<S>* values, int first) {
    return {point_jets<J>(values[0], first), point_jets<J>(values[1], first + 3),
            point_jets<J>(values[2], first + 6), point_jets<J>(values[3], first + 9)};
  }
  template <class S>
  static Ray<S> plain(const Vector3<S>* values) {
    return {values[0], values[1], values[2], values[3]};
  }
};

template <>
struct VectorsOf<Quantity::pose> {
  template <class S>
  using Type = Pose<S>;
  static constexpr std::array kVariables = {Change::point, Change::rotation};
  static constexpr std::size_t kValues = 4;  // translation, columns of the rotation

  template <class S, class J>
  static void to_base(const Pose<S>& frame, const Pose<J>& pose, Vector3<S>* out) {
    out[0] = frame * in_scalar<S>(pose.translation);
    for (int c = 0; c < 3; ++c) {
      out[1 + c] = rotated(frame.rotation, in_scalar<S>(Vector3<J>(pose.rotation.col(c))));
    }
  }
  template <class S, class J>
  static void change(const Pose<S>& frame, const Pose<J>& pose, int k, Vector3<S>* out) {
    VectorsOf<Quantity::point>::change(frame, pose.translation, k, out);
    const auto& r = pose.rotation;  // dR R^T = [w]x
    const auto entry = [&](int row, int column) {
      return r(row, 0).v(k) * r(column, 0).a + r(row, 1).v(k) * r(column, 1).a +
             r(row, 2).v(k) * r(column, 2).a;
    };
    out[1] = rotated(frame.rotation, Vector3<S>(entry(2, 1), entry(0, 2), entry(1, 0)));
  }
  /// The variables of the rotation are a small rotation vector in the base.
  template <class J, class S>
  static Pose<J> jets(const Vector3<S>* values, int first) {
    Pose<J> pose;
    pose.translation = point_jets<J>(values[0], first);
    for (int c = 0; c < 3; ++c) {
      const Vector3<S>& column = values[1 + c];
      for (int k = 0; k < 3; ++k) pose.rotation(k, c) = J(column(k));
      for (int k = 0; k < 3; ++k) {  // e_k x column
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        pose.rotation(i, c).v(first + 3 + k) = -column(j);
        pose.rotation(j, c).v(first + 3 + k) = column(i);
      }
    }
    return pose;
  }
  template <class S>
  static Pose<S> plain(const Vector3<S>* values) {
    Pose<S> pose;
    pose.translation = values[0];
    for (int c = 0; c < 3; ++c) pose.rotation.col(c) = values[1 + c];
    return pose;
  }
};

template <>
struct VectorsOf<Quantity::reading> {
  template <class S>
  using Type = Reading<S>;
  static constexpr std::array kVariables = {Change::point, Change::number};
  static constexpr std::size_t kValues = 2;

  template <class S, class J>
  static void to_base(const Pose<S>& frame, const Reading<J>& reading, Vector3<S>* out) {
    out[0] = frame * in_scalar<S>(reading.origin);
    out[1] = in_scalar<S>(Vector3<J>(reading.value, J(0.0), J(0.0)));
  }
  template <class S, class J>
  static void change(const Pose<S>& frame, const Reading<J>& reading, int k, Vector3<S>* out) {
    VectorsOf<Quantity::point>::change(frame, reading.origin, k, out);
    out[1] = Vector3<S>(reading.value.v(k), S(0.0), S(0.0));
  }
  template <class J, class S>
  static Reading<J> jets(const Vector3<S>* values, int first) {
    return {point_jets<J>(values[0], first), J(values[1].x(), first + 3)};
  }
  template <class S>
  static Reading<S> plain(const Vector3<S>* values) {
    return {values[0], values[1].x()};
  }
};

/// Number of variables of a quantity in jets.
template <Quantity Q>
inline constexpr int kVariablesOf = 3 * static_cast<int>(VectorsOf<Q>::kVariables.size());

}  // namespace detail

}  // namespace kinecal
