// Robust losses: the cost of a feature with squared residual s = |r|^2 is rho(s) / 2.
//
//   none    s
//   huber   s up to c^2, then 2 c sqrt(s) - c^2
//   cauchy  c^2 log(1 + s / c^2)
//   tukey   c^2 / 3 (1 - (1 - s / c^2)^3) up to c^2, then c^2 / 3
//
// All are concave in s with rho(0) = 0 and rho'(0) = 1; hence rho'(s) s <= rho(s), which the
// compressed cost needs (solve/compressed_cost.hpp).
// Source: Triggs et al., Bundle Adjustment - A Modern Synthesis, 3.2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/geometry/packet.hpp"

namespace kinecal {

/// Robust losses, named as in configurations.
enum class LossType {
  none,    ///< least squares
  huber,   ///< linear beyond the scale
  cauchy,  ///< logarithmic beyond the scale
  tukey    ///< constant beyond the scale
};

/// Which losses an evaluation uses.
enum class Losses {
  as_given,  ///< those of the error blocks
  convex     ///< their convex counterparts: see Loss::convex()
};

/// A robust loss of one feature.
struct Loss {
  LossType type = LossType::none;  ///< which function rho is
  double scale = 1.0;              ///< c, in units of the weighted residual

  /// The value of rho at s, and its derivative.
  template <class S>
  struct Value {
    S rho;         ///< rho(s)
    S derivative;  ///< rho'(s)
  };

  /// rho and its derivative.
  /// @param s  squared norm of one feature's weighted residual
  template <class S>
  [[nodiscard]] Value<S> operator()(const S& s) const {
    using std::log1p, std::sqrt;
    const S c(scale), c2(scale * scale), one(1.0);
    switch (type) {
      case LossType::huber: {
        const S root = sqrt(select(s <= c2, c2, s));  // c in the quadratic part
        return {select(s <= c2, s, S(2.0) * c * root - c2), c / root};
      }
      case LossType::cauchy:
        return {c2 * log1p(s / c2), one / (one + s / c2)};
      case LossType::tukey: {
        const S u = select(s >= c2, one, s / c2), t = one - u;
        return {c2 * u * (one - u * (one - u * S(1.0 / 3.0))), t * t};
      }
      case LossType::none:
        break;
    }
    return {s, one};
  }

  /// The loss for a first solve: huber instead of cauchy and tukey, which ignore distant features
  /// and so have several minima.  Its solution is the start for the loss itself.
  [[nodiscard]] Loss convex() const {
    return {type == LossType::none ? LossType::none : LossType::huber, scale};
  }
  /// True for none and huber.
  [[nodiscard]] bool is_convex() const { return type == LossType::none || type == LossType::huber; }
};

}  // namespace kinecal
