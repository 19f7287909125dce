// Error blocks as users would write them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal::test {

/// PointToPoint as a user would write it.
struct UnknownDifference {
  static constexpr const char* kUnit = "m";
  template <class S>
  [[nodiscard]] Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return {p_a.x() - p_b.x(), p_a.y() - p_b.y(), p_a.z() - p_b.z()};
  }
};

/// PointToPoint with a piece that is never used: it is not detected as a difference, so jets
/// compute its derivatives.
struct HiddenDifference {
  static constexpr const char* kUnit = "m";
  template <class S>
  [[nodiscard]] Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    const S x = p_a.x() - p_b.x();
    return {select(x < S(1e9), x, -x), p_a.y() - p_b.y(), p_a.z() - p_b.z()};
  }
};

/// One residual of two points: their distance minus the expected one.
struct Distance {
  static constexpr const char* kUnit = "m";
  double expected = 0.2;
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_a,
                                                  const Vector3<S>& p_b) const {
    using std::sqrt;
    const S x = p_a.x() - p_b.x(), y = p_a.y() - p_b.y(), z = p_a.z() - p_b.z();
    return Eigen::Matrix<S, 1, 1>(sqrt(x * x + y * y + z * z) - expected);
  }
};

/// Five nonlinear residuals of two points.
struct FiveOfTwo {
  static constexpr const char* kUnit = "m";
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 5, 1> operator()(const Vector3<S>& p_a,
                                                  const Vector3<S>& p_b) const {
    using std::cos, std::exp, std::sin;
    Eigen::Matrix<S, 5, 1> r;
    r(0) = p_a.x() * p_b.y() - p_a.y() * p_b.x();
    r(1) = sin(p_a.z()) - sin(p_b.z());
    r(2) = exp(p_a.x()) - exp(p_b.x());
    r(3) = p_a.z() / (p_b.z() * p_b.z() + 1.0) - 0.5;
    r(4) = cos(p_a.y() - p_b.y()) - 1.0;
    return r;
  }
};

}  // namespace kinecal::test
