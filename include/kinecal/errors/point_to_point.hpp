// Two sensors observe the same point (chain3d_to_chain3d).  r = p_a - p_b
// Source: Fetch paper, III-B, hand-eye error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Difference of two observations of a point.
struct PointToPoint {
  static constexpr const char* kType = "chain3d_to_chain3d";  ///< name in configurations
  static constexpr const char* kUnit = "m";                   ///< of the residual

  /// The difference of the points.
  /// @param p_a, p_b  (3) the feature as each sensor observed it, metres, in the base
  /// @returns         (3) metres
  template <class S>
  [[nodiscard]] Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return p_a - p_b;
  }
};

}  // namespace kinecal
