// Error blocks that subtract their two points and do nothing else with them: r = p_a - p_b + c.
//
// Their derivatives are I and -I wherever the points are, so nothing needs to be differentiated or
// multiplied with.  A traced jet finds out once, when a block is added; its author need not tell.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"
#include "kinecal/geometry/traced.hpp"

namespace kinecal {

/// True for blocks of that form.
template <ErrorBlock B>
[[nodiscard]] bool is_difference(const B& block) {
  if constexpr (PointPairBlock<B> && kResiduals<B> == 3) {
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
