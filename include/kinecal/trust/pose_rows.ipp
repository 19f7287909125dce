// The rows of a pose, and the directions in which its features err together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/pose_groups.hpp"

namespace kinecal::detail {

/// Numbers of the blocks of rows of each pose.
[[nodiscard]] inline std::vector<std::vector<std::size_t>> blocks_by_pose(const LinearFit& fit,
                                                                          const PoseGroups& poses) {
  std::vector<std::vector<std::size_t>> all(static_cast<std::size_t>(poses.count));
  for (std::size_t b = 0; b < fit.blocks.size(); ++b) {
    const auto sample = static_cast<std::size_t>(fit.blocks[b].sample);
    all[static_cast<std::size_t>(poses.of_sample[sample])].push_back(b);
  }
  return all;
}

/// Numbers of the rows of some blocks.
[[nodiscard]] inline std::vector<Eigen::Index> rows_of(const LinearFit& fit,
                                                       std::span<const std::size_t> blocks) {
  std::vector<Eigen::Index> rows;
  for (const std::size_t b : blocks) {
    const RowBlock& block = fit.blocks[b];
    for (Eigen::Index i = 0; i < block.size; ++i) rows.push_back(block.first + i);
  }
  return rows;
}

/// Principal axes of A A^T, and their sizes.
struct SharedDirections {
  Eigen::MatrixXd axes;   ///< (rows x axes)
  Eigen::VectorXd sizes;  ///< all positive

  /// None: features err independently.
  explicit SharedDirections(Eigen::Index rows) : axes(rows, 0) {}
  /// @param a  (rows x any)
  explicit SharedDirections(const Eigen::MatrixXd& a) : axes(a.rows(), 0) {
    if (a.cols() == 0) return;  // no joint moves the sensor
    const Eigenpairs pairs = eigenpairs(a.transpose() * a);
    constexpr double kRounding = 1e-9;
    const Eigen::VectorXd& all = pairs.values;
    Eigen::Index rank = 0;
    while (rank < std::min(a.rows(), all.size()) &&
           all(all.size() - 1 - rank) > kRounding * all(all.size() - 1)) {
      ++rank;
    }
    sizes = all.tail(rank);
    axes = a * pairs.vectors.rightCols(rank) * sizes.cwiseSqrt().cwiseInverse().asDiagonal();
  }
  /// (I + t^2 A A^T)^-1/2 times some columns.
  template <class Columns>
  [[nodiscard]] Columns whitened(const Columns& of, double t) const {
    const Eigen::VectorXd taken = 1.0 - (1.0 + t * t * sizes.array()).rsqrt();
    return of - axes * (taken.asDiagonal() * (axes.transpose() * of));
  }
};

}  // namespace kinecal::detail
