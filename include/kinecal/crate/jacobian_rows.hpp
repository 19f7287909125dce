// Rows of the Jacobian of one feature, from what changes its residual and the twists of its chains.
//
// Columns are those of local_columns(): the twists of each body, then the cameras.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/feature_rows.hpp"

namespace kinecal {

/// by_body xi for all twists.
/// @param out  (M x width), row-major
template <class S, int M, int Bodies, class Twists>
void write_rows(const FeatureRows<S, M, Bodies>& rows, const Twists& twists, S* out,
                std::size_t width) {
  for (int m = 0; m < M; ++m, out += width) {
    S* column = out;
    for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
      const Eigen::Matrix<S, 1, 6> l = rows.by_body[s].row(m);
      for (const Twist<S>& t : twists[s].turns) {
        *column++ = (l(0) * t.linear.x() + l(1) * t.linear.y() + l(2) * t.linear.z()) +
                    (l(3) * t.angular.x() + l(4) * t.angular.y() + l(5) * t.angular.z());
      }
      for (const Vector3<S>& v : twists[s].shifts) {
        *column++ = l(0) * v.x() + l(1) * v.y() + l(2) * v.z();
      }
    }
    for (std::size_t c = 0; c < rows.cameras; ++c) *column++ = rows.by_camera[c](m);
  }
}

/// The same for r = p_a - p_b of feature i: the columns are the velocities of the points.
/// @param out  (3 x width), row-major
template <class S, class Twists>
void write_difference(std::span<const SensorView<S>* const> views, std::size_t i,
                      const Twists& twists, S* out, std::size_t width) {
  const auto write = [&out, width](const Vector3<S>& v) {
    out[0] = v.x();
    out[width] = v.y();
    out[2 * width] = v.z();
    ++out;
  };
  const Vector3<S> a = views[0]->points()[i], b = views[1]->points()[i];  // no aliases of out
  for (const Twist<S>& t : twists[0].turns) write(t.velocity(a));
  for (const Vector3<S>& v : twists[0].shifts) write(v);
  for (const Twist<S>& t : twists[1].turns) write(t.opposite_velocity(b));
  for (const Vector3<S>& v : twists[1].shifts) write(-v);
  for (const Vector3<S>& v : views[0]->camera_motion(i)) write(v);
  for (const Vector3<S>& v : views[1]->camera_motion(i)) write(-v);
}

}  // namespace kinecal
