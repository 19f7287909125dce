// Detects error blocks that only subtract their two points: r = p_a - p_b + c.
//
// Their derivatives are I and -I wherever the points are, so evaluation neither differentiates nor
// multiplies.  A traced jet detects this when the block is added; the author declares nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"
#include "kinecal/geometry/traced.hpp"

namespace kinecal {

/// True if r = p_a - p_b + c with a constant c, wherever the points are.
template <ErrorBlock B>
[[nodiscard]] bool is_difference(const B& block) {
  if constexpr (PointPairBlock<B> && kResiduals<B> == 3 && detail::kTakesFeaturesOnly<B>) {
    using J = Jet<Traced, 6>;
    const auto varying = [](double x, double y, double z) {
      return Vector3<Traced>(Traced(x, true), Traced(y, true), Traced(z, true));
    };
    const auto r =
        block(point_jets<J>(varying(0.3, -0.7, 1.1), 0), point_jets<J>(varying(-0.2, 0.5, 0.9), 3));
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 6; ++k) {
        const Traced& d = r(row).v(k);
        const double expected = k % 3 != row ? 0.0 : (k < 3 ? 1.0 : -1.0);
        if (d.varies || d.value != expected) return false;
      }
    }
    return true;
  } else {
    return false;
  }
}

}  // namespace kinecal
