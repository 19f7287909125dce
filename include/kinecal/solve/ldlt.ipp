// Definitions of ldlt.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kinecal/solve/ldlt.hpp"

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

}  // namespace kinecal::detail
