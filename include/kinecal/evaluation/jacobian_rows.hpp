// Rows of the Jacobian of one feature, from its derivatives and the twists of its chains.
//
// The columns are those of a FeatureRun.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/feature_rows.hpp"

namespace kinecal::detail {

/// Writes by_own, and by_body xi for all twists.
/// @param out  (M x width), row-major
template <class S, int M, int Bodies, class Twists>
void write_rows(const FeatureRows<S, M, Bodies>& rows, const Twists& twists, S* out,
                std::size_t width) {
  for (int m = 0; m < M; ++m, out += width) {
    S* column = out;
    for (std::size_t c = 0; c < rows.own; ++c) *column++ = rows.by_own[c](m);
    for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
      const Eigen::Matrix<S, 1, 6> l = rows.by_body[s].row(m);
      for (const Twist<S>& t : twists[s].rotational) {
        *column++ = (l(0) * t.linear.x() + l(1) * t.linear.y() + l(2) * t.linear.z()) +
                    (l(3) * t.angular.x() + l(4) * t.angular.y() + l(5) * t.angular.z());
      }
    }
    for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
      const Eigen::Matrix<S, 1, 3> l = rows.by_body[s].row(m).template head<3>();
      for (const Vector3<S>& v : twists[s].translational) {
        *column++ = l(0) * v.x() + l(1) * v.y() + l(2) * v.z();
      }
    }
  }
}

/// Writes the Jacobian of r = p_a - p_b for the features of a run: its columns are velocities of the
/// points.
/// @param out    (3 features x columns), row-major
/// @param visit  callable (feature, p_a, p_b), called for each feature
template <class S, class Visit>
void write_differences(const TermViews<S>& views, const FeatureRun& run,
                       const std::array<BodyTwists<S>, 2>& twists, S* out, Visit&& visit) {
  // Copies: the compiler would read them again after each number that is written.
  const BodyTwists<S> of_a = twists[0], of_b = twists[1];
  const std::size_t width = run.columns.size();
  const std::size_t own_a = views[0].own().free.size(), own_b = views[1].own().free.size();
  const Vector3<S>*points_a = views[0].values(0), *points_b = views[1].values(0);
  const Vector3<S>*changes_a = views[0].changes(run.first),
        *changes_b = views[1].changes(run.first);
  const auto write = [&out, width](const Vector3<S>& v) {
    out[0] = v.x();
    out[width] = v.y();
    out[2 * width] = v.z();
    ++out;
  };
  const auto opposite = [](const Vector3<S>& v) { return Vector3<S>(-v.x(), -v.y(), -v.z()); };
  for (std::size_t i = run.first; i < run.end; ++i, out += 2 * width) {
    const Vector3<S> a = points_a[i], b = points_b[i];
    visit(i, a, b);
    for (std::size_t k = 0; k < own_a; ++k) write(*changes_a++);
    for (std::size_t k = 0; k < own_b; ++k) write(opposite(*changes_b++));
    for (const Twist<S>& twist : of_a.rotational) write(twist.velocity(a));
    for (const Twist<S>& twist : of_b.rotational) write(twist.opposite_velocity(b));
    for (const Vector3<S>& v : of_a.translational) write(v);
    for (const Vector3<S>& v : of_b.translational) write(opposite(v));
  }
}

}  // namespace kinecal::detail
