// A measurement without error: what a sensor would have measured if the model were exact.
//
//   x <- x - J^+ r        J = dr/dx by jets
//
// One Newton step, exact if the block is linear, lane by lane, in the base: it costs little, so each
// evaluation can take it.  study/exact_samples.hpp repeats the step until it converges, for all blocks
// of a feature together, and gives recorded samples.
// Source: ARCHITECTURE.md, the error-free problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/geometry/packet.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/sensors/quantity_vectors.hpp"

namespace kinecal::detail {

/// The shortest step of V variables that makes r + D x zero, or the smallest r if V < M; lane by
/// lane.  Zero for variables that do not affect r.
template <class S, int M, int V>
[[nodiscard]] Eigen::Matrix<S, V, 1> shortest_step(const Eigen::Matrix<S, M, 1>& residual,
                                                   const Eigen::Matrix<S, M, V>& derivatives) {
  constexpr int kSmaller = std::min(M, V);
  static_assert(kSmaller <= 6, "solve_small() takes no more");
  Eigen::Matrix<S, V, 1> step;
  for (int i = 0; i < kLanes<S>; ++i) {
    const Eigen::Matrix<double, M, 1> r = lane_of(residual, i);
    const Eigen::Matrix<double, M, V> d = lane_of(derivatives, i);
    Eigen::Matrix<double, V, 1> x;
    Eigen::Matrix<double, kSmaller, kSmaller> squares;
    if constexpr (M <= V) {
      squares.noalias() = d * d.transpose();
      Eigen::Matrix<double, M, 1> multipliers = r;
      solve_small(squares.data(), multipliers.data(), M);
      x.noalias() = d.transpose() * multipliers;
    } else {
      squares.noalias() = d.transpose() * d;
      x.noalias() = d.transpose() * r;
      solve_small(squares.data(), x.data(), V);
    }
    for (int k = 0; k < V; ++k) set_lane(step(k), i, -x(k));
  }
  return step;
}

/// Moves the measured vectors of a sensor by the shortest step that makes the residual zero.
/// @tparam kInput  what the block takes of the sensor
/// @tparam kFirst  the sensor's first variable in the jets
/// @param r        the residual as jets of all vectors
/// @param values   of the sensor, in the order of VectorsOf
/// @param moved    out: the same, moved
template <Quantity kInput, int kFirst, class R, class S>
void move_measurement(const R& r, const Vector3<S>* values, std::array<Vector3<S>, 4>& moved) {
  std::copy_n(values, VectorsOf<kInput>::kValues, moved.begin());
  // A ray measures the direction, a reading the number.
  constexpr int kFrom = kFirst + (kInput == Quantity::ray || kInput == Quantity::reading ? 3 : 0);
  constexpr int kCount = kInput == Quantity::pose ? 6 : kInput == Quantity::reading ? 1 : 3;
  const Eigen::Matrix<S, kCount, 1> step = shortest_step<S, R::RowsAtCompileTime, kCount>(
      values_of(r), derivatives_by<kCount>(r, kFrom));
  if constexpr (kInput == Quantity::reading) {
    moved[1].x() += step(0);
  } else if constexpr (kInput == Quantity::pose) {
    moved[0] += step.template head<3>();
    for (int i = 0; i < kLanes<S>; ++i) {  // exp() branches
      const Matrix3<double> rotation =
          exp(Vector3<double>(lane(step(3), i), lane(step(4), i), lane(step(5), i)));
      for (std::size_t c = 1; c < 4; ++c) {
        const Vector3<double> turned = rotation * lane_of(moved[c], i);
        for (int k = 0; k < 3; ++k) set_lane(moved[c](k), i, turned(k));
      }
    }
  } else {
    moved[kInput == Quantity::ray ? 1 : 0] += step;
  }
}

}  // namespace kinecal::detail
