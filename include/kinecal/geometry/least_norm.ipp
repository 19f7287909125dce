// Definition of least_norm.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/QR>

#include "kinecal/geometry/least_norm.hpp"

namespace kinecal::detail {

KINECAL_INLINE Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& a,
                                                   const Eigen::MatrixXd& b) {
  if (a.size() == 0) return Eigen::MatrixXd::Zero(a.cols(), b.cols());  // Eigen reads beyond it
  return a.completeOrthogonalDecomposition().solve(b);
}

}  // namespace kinecal::detail
