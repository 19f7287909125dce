// The second derivative of a loss.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/errors/loss.hpp"

namespace kinecal::detail {

/// rho'' of a loss by central differences of rho'.
[[nodiscard]] inline double curvature_of(const Loss& loss, double squared) {
  const double h = 1e-4 * (squared + 1e-3 * loss.scale * loss.scale);
  const double low = std::max(0.0, squared - h);
  return (loss(squared + h).derivative - loss(low).derivative) / (squared + h - low);
}

}  // namespace kinecal::detail
