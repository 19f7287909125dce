// Definitions of ldlt.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kinecal/geometry/ldlt.hpp"

namespace kinecal::detail {

KINECAL_INLINE Ldlt::Ldlt(const Eigen::MatrixXd& matrix) : ldlt_(matrix) {}

KINECAL_INLINE Eigen::VectorXd Ldlt::solve(const Eigen::VectorXd& b) const {
  return ldlt_.solve(b);
}

KINECAL_INLINE Eigen::MatrixXd Ldlt::solve(const Eigen::MatrixXd& b) const {
  return ldlt_.solve(b);
}

KINECAL_INLINE double Ldlt::least_pivot() const {
  if (ldlt_.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  return ldlt_.vectorD().minCoeff();
}

KINECAL_INLINE void solve_small(const double* matrix, double* b, int n) {
  constexpr int kMost = 6;
  using Small =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMost, kMost>;
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMost, 1>;
  Eigen::Map<SmallVector> x(b, n);
  x = Eigen::LDLT<Small>(Eigen::Map<const Small>(matrix, n, n)).solve(SmallVector(x)).eval();
}

}  // namespace kinecal::detail
