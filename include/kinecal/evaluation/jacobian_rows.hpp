// Rows of the Jacobian of one feature, from its derivatives and the twists of its chains.
//
// The columns are those of TermViews::columns(): the twists of each body, then own parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/feature_rows.hpp"

namespace kinecal {

/// Writes by_body xi for all twists, and by_own.
/// @param out  (M x width), row-major
template <class S, int M, int Bodies, class Twists>
void write_rows(const FeatureRows<S, M, Bodies>& rows, const Twists& twists, S* out,
                std::size_t width) {
  for (int m = 0; m < M; ++m, out += width) {
    S* column = out;
    for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
      const Eigen::Matrix<S, 1, 6> l = rows.by_body[s].row(m);
      for (const Twist<S>& t : twists[s].rotational) {
        *column++ = (l(0) * t.linear.x() + l(1) * t.linear.y() + l(2) * t.linear.z()) +
                    (l(3) * t.angular.x() + l(4) * t.angular.y() + l(5) * t.angular.z());
      }
      for (const Vector3<S>& v : twists[s].translational) {
        *column++ = l(0) * v.x() + l(1) * v.y() + l(2) * v.z();
      }
    }
    for (std::size_t c = 0; c < rows.own; ++c) *column++ = rows.by_own[c](m);
  }
}

/// Number of columns of a body and its sensor.
struct BodySizes {
  std::size_t rotational = 0;     ///< rotational twists
  std::size_t translational = 0;  ///< translational twists
  std::size_t own = 0;            ///< free parameters of the sensor

  /// Number of all columns.
  [[nodiscard]] constexpr std::size_t columns() const { return rotational + translational + own; }
  bool operator==(const BodySizes&) const = default;  ///< all members are equal
};

/// Sizes of two bodies that the compiler knows, so that loops over them unroll.
template <BodySizes A, BodySizes B>
struct KnownSizes {                  // Its members are named as those of Sizes.
  static constexpr BodySizes a = A;  ///< of the first body   NOLINT(readability-identifier-naming)
  static constexpr BodySizes b = B;  ///< of the second body  NOLINT(readability-identifier-naming)
};
/// Sizes of two bodies that are known at run time.
struct Sizes {
  BodySizes a;  ///< of the first body
  BodySizes b;  ///< of the second body
};

/// Writes the rows of consecutive features of r = p_a - p_b: columns are velocities of the points.
/// @param sizes  Sizes or KnownSizes; must be the number of twists and own parameters
/// @param out    (3 features x columns), row-major
/// @param visit  callable (feature, p_a, p_b), called for each feature
template <class S, class AnySizes, class Visit>
void write_differences(const TermViews<S>& views, std::size_t first, std::size_t end,
                       const std::array<BodyTwists<S>, 2>& twists, const AnySizes& sizes, S* out,
                       Visit&& visit) {
  const Twist<S>*rotational_a = twists[0].rotational.data(),
        *rotational_b = twists[1].rotational.data();
  const Vector3<S>*translational_a = twists[0].translational.data(),
        *translational_b = twists[1].translational.data();
  const Vector3<S>*points_a = views[0].points().data(), *points_b = views[1].points().data();
  const std::size_t width = sizes.a.columns() + sizes.b.columns();
  const auto write = [&out, width](const Vector3<S>& v) {
    out[0] = v.x();
    out[width] = v.y();
    out[2 * width] = v.z();
    ++out;
  };
  for (std::size_t i = first; i < end; ++i, out += 2 * width) {
    const Vector3<S> a = points_a[i], b = points_b[i];
    visit(i, a, b);
    for (std::size_t k = 0; k < sizes.a.rotational; ++k) write(rotational_a[k].velocity(a));
    for (std::size_t k = 0; k < sizes.a.translational; ++k) write(translational_a[k]);
    for (std::size_t k = 0; k < sizes.b.rotational; ++k)
      write(rotational_b[k].opposite_velocity(b));
    for (std::size_t k = 0; k < sizes.b.translational; ++k) write(-translational_b[k]);
    const Vector3<S>*change_a = views[0].changes(i), *change_b = views[1].changes(i);
    for (std::size_t k = 0; k < sizes.a.own; ++k) write(change_a[k]);
    for (std::size_t k = 0; k < sizes.b.own; ++k) write(-change_b[k]);
  }
}

}  // namespace kinecal
