// Eigenvalues and eigenvectors of symmetric matrices of any size, compiled once: every source that
// instantiates Eigen's own class takes seconds longer to compile.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/eigen_layout.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// A = V diag(values) V^T.
struct Eigenpairs {
  Eigen::VectorXd values;   ///< (n) ascending
  Eigen::MatrixXd vectors;  ///< (n x n) orthonormal, in the same order
};

/// @param matrix  (n x n) symmetric: only its lower triangle is read; n > 0
[[nodiscard]] Eigenpairs eigenpairs(const Eigen::MatrixXd& matrix);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/geometry/eigenpairs.ipp"
#endif
