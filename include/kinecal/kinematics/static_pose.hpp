// Compile-time poses: zeros and ones in them cost nothing.
//
// A type P with P::kPose (a PoseData) stands for the pose.  Most origins of a URDF only translate
// along one axis; a rotation by 90 degrees only swaps columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/robot_data.hpp"

namespace kinecal {

namespace detail {

/// Column `Col` of the rotation, or the translation (3).
template <class P, int Col>
struct ConstantColumn {
  [[nodiscard]] static constexpr double at(std::size_t k) {
    return Col < 3 ? P::kPose.rotation[3 * k + std::size_t(Col)] : P::kPose.translation[k];
  }
  static constexpr std::size_t kFirst = at(0) != 0.0 ? 0 : at(1) != 0.0 ? 1 : at(2) != 0.0 ? 2 : 3;
};

template <class C, std::size_t K, class S>
[[nodiscard]] S times(const S& x) {
  if constexpr (C::at(K) == 1.0) {
    return x;
  } else if constexpr (C::at(K) == -1.0) {
    return S(-x);
  } else {
    return S(x * C::at(K));
  }
}

template <class C, std::size_t K, class S>
void add_times(S& sum, const S& x) {
  if constexpr (K <= C::kFirst || C::at(K) == 0.0) {
    return;
  } else if constexpr (C::at(K) == 1.0) {
    sum += x;
  } else if constexpr (C::at(K) == -1.0) {
    sum -= x;
  } else {
    sum += S(x * C::at(K));
  }
}

/// A row of a matrix times a constant column.
template <class C, class S>
[[nodiscard]] S row_times(const std::array<S, 3>& row) {
  static_assert(C::kFirst < 3);
  S sum = times<C, C::kFirst>(row[C::kFirst]);
  add_times<C, 1>(sum, row[1]);
  add_times<C, 2>(sum, row[2]);
  return sum;
}

template <class P>
inline constexpr bool kTurns =
    !(P::kPose.rotation == std::array{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});

}  // namespace detail

/// pose = pose * P::kPose.
template <class P, class S>
void multiply_by_constant(Pose<S>& pose) {
  Matrix3<S>& r = pose.rotation;
  for (int i = 0; i < 3; ++i) {
    const std::array<S, 3> row = {r(i, 0), r(i, 1), r(i, 2)};
    if constexpr (detail::ConstantColumn<P, 3>::kFirst < 3) {
      pose.translation(i) += detail::row_times<detail::ConstantColumn<P, 3>>(row);
    }
    if constexpr (detail::kTurns<P>) {
      r(i, 0) = detail::row_times<detail::ConstantColumn<P, 0>>(row);
      r(i, 1) = detail::row_times<detail::ConstantColumn<P, 1>>(row);
      r(i, 2) = detail::row_times<detail::ConstantColumn<P, 2>>(row);
    }
  }
}

}  // namespace kinecal
