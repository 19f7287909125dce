// What lenses have in common whose image depends on the angle from the axis alone: what is seen at m is
// (a(q) m, b(q)) with q = |m|^2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lenses/lens_model.hpp"

namespace kinecal::detail {

/// What is seen at a place of the image of a round lens.
/// @param a, b              as above
/// @param a_slope, b_slope  their derivatives by q
template <class S>
[[nodiscard]] Sight<S> round_sight(const Eigen::Matrix<S, 2, 1>& m, const S& a, const S& a_slope,
                                   const S& b, const S& b_slope) {
  const S x = m.x(), y = m.y(), mixed = 2.0 * (a_slope * x * y);
  return {{a * x, a * y, b},
          {a + 2.0 * (a_slope * x * x), mixed, 2.0 * (b_slope * x)},
          {mixed, a + 2.0 * (a_slope * y * y), 2.0 * (b_slope * y)}};
}

}  // namespace kinecal::detail
