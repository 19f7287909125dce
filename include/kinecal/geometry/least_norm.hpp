// Linear least squares with matrices of any size and rank, compiled once, as eigenpairs.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/eigen_layout.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// X = A^+ B: of all X with the least |A X - B| the one of least norm.
/// @param a  (m x n) of any rank
/// @param b  (m x k)
/// @returns  (n x k)
[[nodiscard]] Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& a,
                                                  const Eigen::MatrixXd& b);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/geometry/least_norm.ipp"
#endif
