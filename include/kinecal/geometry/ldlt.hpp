// Linear systems with symmetric matrices of any size, compiled once, as eigenpairs.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

#include "kinecal/geometry/eigen_layout.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// P A P^T = L D L^T, with the largest pivots first.
class Ldlt {
 public:
  /// @param matrix  (n x n) symmetric: only its lower triangle is read
  explicit Ldlt(const Eigen::MatrixXd& matrix);
  /// x (n) of A x = b.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// X (n x k) of A X = B.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// The least entry of D; -infinity if there is no such D.
  [[nodiscard]] double least_pivot() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

/// The same for at most six rows, without the heap.
/// @param matrix  (n x n) symmetric, positive semidefinite: only its lower triangle is read; n <= 6
/// @param b       (n) in: the right side; out: x, zero where the matrix is
void solve_small(const double* matrix, double* b, int n);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/geometry/ldlt.ipp"
#endif
