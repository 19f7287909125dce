// Definitions of eigenpairs.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Eigenvalues>

#include "kinecal/geometry/eigenpairs.hpp"

namespace kinecal::detail {

KINECAL_INLINE Eigenpairs eigenpairs(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace kinecal::detail
