// Robust losses: how much a feature's squared residual s = |r|^2 costs.  cost = rho(s) / 2
//
//   none    s
//   huber   s up to c^2, then 2 c sqrt(s) - c^2
//   cauchy  c^2 log(1 + s / c^2)
//   tukey   c^2 / 3 (1 - (1 - s / c^2)^3) up to c^2, then c^2 / 3
//
// All are concave in s with rho(0) = 0, rho'(0) = 1; hence rho'(s) s <= rho(s), on which the
// compressed cost relies (solve/compressed_cost.hpp).
// Source: Triggs et al., Bundle Adjustment - A Modern Synthesis, 3.2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace kinecal {

enum class LossType { none, huber, cauchy, tukey };

struct Loss {
  LossType type = LossType::none;
  double scale = 1.0;  ///< c, in units of the weighted residual

  struct Value {
    double rho, derivative;
  };

  /// @param s  squared norm of one feature's weighted residual
  [[nodiscard]] Value operator()(double s) const {
    const double c2 = scale * scale;
    switch (type) {
      case LossType::huber:
        if (s <= c2) return {s, 1.0};
        return {2.0 * scale * std::sqrt(s) - c2, scale / std::sqrt(s)};
      case LossType::cauchy:
        return {c2 * std::log1p(s / c2), 1.0 / (1.0 + s / c2)};
      case LossType::tukey: {
        if (s >= c2) return {c2 / 3.0, 0.0};
        const double t = 1.0 - s / c2;
        return {c2 / 3.0 * (1.0 - t * t * t), t * t};
      }
      case LossType::none:
        break;
    }
    return {s, 1.0};
  }

  /// A loss with a single minimum that treats outliers alike: huber in place of cauchy and tukey,
  /// which no longer see what is far away.  From it the loss itself is started.
  [[nodiscard]] Loss convex() const {
    return {type == LossType::none ? LossType::none : LossType::huber, scale};
  }
  [[nodiscard]] bool is_convex() const { return type == LossType::none || type == LossType::huber; }
};

}  // namespace kinecal
