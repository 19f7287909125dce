// The residual of one feature and its derivatives, before kinematics: the only format of rows.
//
// For any error block, a residual changes only because rigid bodies move (one per sensor:
// everything at the end of its chain), or because parameters of sensors or of the block change:
//
//   dr = sum over bodies of  by_body (v, w)  +  sum over own parameters of  by_own dk
//
// with the twist (v, w) of the body in the base.  A point p with dr = D dp gives by_body =
// D [I, -[p]x]: a row d of D becomes (d, p x d).  The free parameters of a chain enter later, once
// for all features: see local_sums.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/evaluation/views/term_views.hpp"
#include "kinecal/problem/term.hpp"

namespace kinecal::detail {

/// Residual of one feature and its derivatives.
template <class S, int M, int Bodies>
struct FeatureRows {
  S present{1.0};                   ///< one, or zero where the feature is missing
  Eigen::Matrix<S, M, 1> residual;  ///< (M) unweighted
  std::array<Eigen::Matrix<S, M, 6>, Bodies> by_body;   ///< by linear, by angular
  std::array<Eigen::Matrix<S, M, 1>, kMostOwn> by_own;  ///< by each free parameter of sensors and
                                                        ///< block
  std::size_t own = 0;                                  ///< number of them

  /// Sets the rows of a body with one point.
  /// @param p         (3) in the base, metres
  /// @param by_point  (M x 3) derivative of the residual with respect to it: D
  void set_point(std::size_t body, const Vector3<S>& p, const Eigen::Matrix<S, M, 3>& by_point) {
    for (int row = 0; row < M; ++row) {
      const Vector3<S> d = by_point.row(row);
      by_body[body].row(row) << d.transpose(), cross(p, d).transpose();
    }
  }
  /// Adds the contribution of a vector that only rotates with the body.
  /// @param x     (3) the vector, in the base
  /// @param by_x  (M x 3) derivative of the residual with respect to it
  void add_vector(std::size_t body, Change change, const Vector3<S>& x,
                  const Eigen::Matrix<S, M, 3>& by_x) {
    if (change == Change::number) return;
    for (int row = 0; row < M; ++row) {
      const Vector3<S> d = by_x.row(row), moment = change == Change::rotation ? d : cross(x, d);
      by_body[body].row(row).template tail<3>() += moment.transpose();
    }
  }
};

/// Writes the derivatives of a feature, column after column: by_own, and by_body xi for all twists.
/// @param out  (M x columns), column-major
template <class S, int M, int Bodies, class Twists>
void write_columns(const FeatureRows<S, M, Bodies>& rows, const Twists& twists, S* out) {
  for (std::size_t c = 0; c < rows.own; ++c) {
    for (int m = 0; m < M; ++m) *out++ = rows.by_own[c](m);
  }
  for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
    const Eigen::Matrix<S, M, 6>& l = rows.by_body[s];
    for (const Twist<S>& t : twists[s]->rotational) {
      for (int m = 0; m < M; ++m) {
        *out++ = (l(m, 0) * t.linear.x() + l(m, 1) * t.linear.y() + l(m, 2) * t.linear.z()) +
                 (l(m, 3) * t.angular.x() + l(m, 4) * t.angular.y() + l(m, 5) * t.angular.z());
      }
    }
  }
  for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
    const Eigen::Matrix<S, M, 6>& l = rows.by_body[s];
    for (const Vector3<S>& v : twists[s]->translational) {
      for (int m = 0; m < M; ++m) {
        *out++ = l(m, 0) * v.x() + l(m, 1) * v.y() + l(m, 2) * v.z();
      }
    }
  }
}

}  // namespace kinecal::detail
