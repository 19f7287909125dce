// The position of a joint with its sine and cosine, so that the walk needs no trigonometry.
//
// Sine and cosine are computed once per sample for a measured position and once per evaluation for
// an offset.  The walk combines the two by angle addition:
//
//   cos(q + d) = cos q cos d - sin q sin d      sin(q + d) = sin q cos d + cos q sin d
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/kinematics/joint.hpp"

namespace kinecal {

/// A joint's position with its cosine and sine.
template <class S>
struct JointState {
  S position{0.0};  ///< radians or metres
  S cos{1.0};       ///< of the position; unused by prismatic joints
  S sin{0.0};       ///< of the position; unused by prismatic joints

  /// The opposite motion.
  [[nodiscard]] JointState inverse() const { return {S(-position), cos, S(-sin)}; }
};

/// The motion to a position, radians or metres.
template <class S>
[[nodiscard]] JointState<S> make_joint_state(const S& position) {
  using std::cos, std::sin;
  return {position, S(cos(position)), S(sin(position))};
}

/// Two motions in sequence: positions add up.
template <class S, class U>
[[nodiscard]] auto operator+(const JointState<S>& a, const JointState<U>& b) {
  using R = Product<S, U>;
  return JointState<R>{R(a.position + b.position), R(a.cos * b.cos - a.sin * b.sin),
                       R(a.sin * b.cos + a.cos * b.sin)};
}

/// (3 x 3) rotation by a motion about a unit axis a: cos I + sin [a]x + (1 - cos) a a^T.
template <class S>
[[nodiscard]] Matrix3<S> axis_rotation(const Vector3<double>& a, const JointState<S>& motion) {
  const S& c = motion.cos;
  const S& s = motion.sin;
  const S d = S(1.0) - c;
  Matrix3<S> r;
  r << S(c + d * (a.x() * a.x())), S(d * (a.x() * a.y()) - s * a.z()),
      S(d * (a.x() * a.z()) + s * a.y()), S(d * (a.x() * a.y()) + s * a.z()),
      S(c + d * (a.y() * a.y())), S(d * (a.y() * a.z()) - s * a.x()),
      S(d * (a.x() * a.z()) - s * a.y()), S(d * (a.y() * a.z()) + s * a.x()),
      S(c + d * (a.z() * a.z()));
  return r;
}

/// Pose of a joint that has moved: rotated about its axis or shifted along it.
/// @param axis  (3) unit vector, in the joint's frame
template <class S>
[[nodiscard]] Pose<S> joint_pose(JointType type, const Vector3<double>& axis,
                                 const JointState<S>& motion) {
  Pose<S> pose;
  if (turns(type)) pose.rotation = axis_rotation(axis, motion);
  if (type == JointType::prismatic) {
    for (int i = 0; i < 3; ++i) pose.translation(i) = S(motion.position * axis(i));
  }
  return pose;
}

/// rotation = rotation * axis_rotation(axis, motion).
/// @param axis  (3) any unit vector, in the rotated frame
template <class S, class U>
void turn_about(Matrix3<S>& rotation, const Vector3<double>& axis, const JointState<U>& motion) {
  const Matrix3<U> turn = axis_rotation(axis, motion);
  for (int row = 0; row < 3; ++row) {
    const Vector3<S> r = rotation.row(row);
    for (int c = 0; c < 3; ++c) {
      rotation(row, c) = sum_of_products<S>(r(0), turn(0, c), r(1), turn(1, c), r(2), turn(2, c));
    }
  }
}

namespace detail {
/// A rotation about axis K mixes the two other columns.
template <int K, class S, class U>
void turn_columns(Matrix3<S>& rotation, const JointState<U>& motion) {
  constexpr int kI = (K + 1) % 3, kJ = (K + 2) % 3;
  for (int row = 0; row < 3; ++row) {
    const S x = rotation(row, kI), y = rotation(row, kJ);
    rotation(row, kI) = S(S(x * motion.cos) + S(y * motion.sin));
    rotation(row, kJ) = S(S(y * motion.cos) - S(x * motion.sin));
  }
}
}  // namespace detail

/// The same about a principal axis of the rotated frame.
/// @param principal  0, 1, 2 for x, y, z
template <class S, class U>
void turn_about(Matrix3<S>& rotation, int principal, const JointState<U>& motion) {
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
