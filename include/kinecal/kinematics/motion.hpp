// How far a joint has moved, with its trigonometry: no sine or cosine is taken inside the walk.
//
// The sine and cosine of a measured position are found once per sample, those of an offset once per
// evaluation; the walk adds the two by
//
//   cos(q + d) = cos q cos d - sin q sin d      sin(q + d) = sin q cos d + cos q sin d
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/kinematics/joint.hpp"

namespace kinecal {

template <class S>
struct Motion {
  S position{0.0};  ///< radians or metres
  S cos{1.0};
  S sin{0.0};

  [[nodiscard]] Motion inverse() const { return {-position, cos, -sin}; }
};

template <class S>
[[nodiscard]] Motion<S> make_motion(const S& position) {
  using std::cos, std::sin;
  return {position, cos(position), sin(position)};
}

template <class S, class U>
[[nodiscard]] auto operator+(const Motion<S>& a, const Motion<U>& b) {
  using R = decltype(a.cos * b.cos);
  return Motion<R>{a.position + b.position, a.cos * b.cos - a.sin * b.sin,
                   a.sin * b.cos + a.cos * b.sin};
}

/// Rotation by a motion about a unit axis: cos I + sin [a]x + (1 - cos) a a^T.
template <class S>
[[nodiscard]] Matrix3<S> axis_rotation(const Vector3<double>& a, const Motion<S>& motion) {
  const S& c = motion.cos;
  const S& s = motion.sin;
  const S d = S(1.0) - c;
  Matrix3<S> r;
  r << c + d * (a.x() * a.x()), d * (a.x() * a.y()) - s * a.z(), d * (a.x() * a.z()) + s * a.y(),
      d * (a.x() * a.y()) + s * a.z(), c + d * (a.y() * a.y()), d * (a.y() * a.z()) - s * a.x(),
      d * (a.x() * a.z()) - s * a.y(), d * (a.y() * a.z()) + s * a.x(), c + d * (a.z() * a.z());
  return r;
}

/// Pose of a moved joint: a turn about its axis or a shift along it.
template <class S>
[[nodiscard]] Pose<S> joint_pose(JointType type, const Vector3<double>& axis,
                                 const Motion<S>& motion) {
  Pose<S> pose;
  if (turns(type)) pose.rotation = axis_rotation(axis, motion);
  if (type == JointType::prismatic) {
    for (int i = 0; i < 3; ++i) pose.translation(i) = motion.position * axis(i);
  }
  return pose;
}

/// rotation = rotation * turn by a motion about any unit axis of its frame.
template <class S, class U>
void turn_about(Matrix3<S>& rotation, const Vector3<double>& axis, const Motion<U>& motion) {
  const Matrix3<U> turn = axis_rotation(axis, motion);
  for (int row = 0; row < 3; ++row) {
    const Vector3<S> r = rotation.row(row);
    for (int c = 0; c < 3; ++c) {
      rotation(row, c) = r(0) * turn(0, c) + r(1) * turn(1, c) + r(2) * turn(2, c);
    }
  }
}

namespace detail {
/// About axis K the two other columns turn into each other.
template <int K, class S, class U>
void turn_columns(Matrix3<S>& rotation, const Motion<U>& motion) {
  constexpr int kI = (K + 1) % 3, kJ = (K + 2) % 3;
  for (int row = 0; row < 3; ++row) {
    const S x = rotation(row, kI), y = rotation(row, kJ);
    rotation(row, kI) = x * motion.cos + y * motion.sin;
    rotation(row, kJ) = y * motion.cos - x * motion.sin;
  }
}
}  // namespace detail

/// The same about one of the axes of its frame: 0, 1, 2 for x, y, z.
template <class S, class U>
void turn_about(Matrix3<S>& rotation, int principal, const Motion<U>& motion) {
  switch (principal) {
    case 0:
      return detail::turn_columns<0>(rotation, motion);
    case 1:
      return detail::turn_columns<1>(rotation, motion);
    default:
      return detail::turn_columns<2>(rotation, motion);
  }
}

}  // namespace kinecal
