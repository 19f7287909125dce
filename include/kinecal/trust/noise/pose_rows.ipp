// The rows of a pose, and the directions in which its features err together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/common_noise.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

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

/// A shift of all features of an error block alike: a column for each of its components, with ones.
/// @param components  of a feature of each error block
[[nodiscard]] inline Eigen::MatrixXd feature_shifts(const LinearFit& fit,
                                                    std::span<const int> components) {
  std::vector<Eigen::Index> first;  // column of each error block
  Eigen::Index columns = 0;
  for (const int size : components) {
    first.push_back(columns);
    columns += size;
  }
  Eigen::MatrixXd shifts = Eigen::MatrixXd::Zero(fit.residual.size(), columns);
  for (const RowBlock& block : fit.blocks) {
    const auto term = static_cast<std::size_t>(block.term);
    for (Eigen::Index i = 0; i < block.size; ++i) {
      shifts(block.first + i, first[term] + i % components[term]) = 1.0;
    }
  }
  return shifts;
}

/// Principal axes of A A^T, and their sizes.
struct SharedDirections {
  Eigen::MatrixXd axes;   ///< (rows x axes)
  Eigen::VectorXd sizes;  ///< all positive

  /// None: features err independently.
  explicit SharedDirections(Eigen::Index rows) : axes(rows, 0) {}
  /// @param a  (rows x any)
  explicit SharedDirections(const Eigen::MatrixXd& a) : axes(a.rows(), 0) {
    if (a.cols() == 0) return;
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
  /// (I + A A^T)^-1/2 times some columns.
  template <class Columns>
  [[nodiscard]] Columns whitened(const Columns& of) const {
    const Eigen::VectorXd taken = 1.0 - (1.0 + sizes.array()).rsqrt();
    return of - axes * (taken.asDiagonal() * (axes.transpose() * of));
  }
};

/// Orthonormal axes of what features of a pose share: see common_noise.hpp.
struct SharedAxes {
  Eigen::MatrixXd shifts;  ///< (rows x axes) Q
  Eigen::MatrixXd others;  ///< (rows x axes) R

  /// @param effects  (rows x joints) see joint_effects()
  /// @param shifted  (rows x components) see feature_shifts()
  SharedAxes(const Eigen::MatrixXd& effects, const Eigen::MatrixXd& shifted)
      : shifts(SharedDirections(shifted).axes) {
    const Eigen::MatrixXd reached = SharedDirections(effects).axes;
    const SharedDirections rest(Eigen::MatrixXd(reached - shifts * (shifts.transpose() * reached)));
    constexpr double kRounding = 1e-9;
    others = rest.axes.rightCols((rest.sizes.array() > kRounding).count());
  }
  /// (rows x axes)
  [[nodiscard]] Eigen::MatrixXd all() const {
    Eigen::MatrixXd both(shifts.rows(), shifts.cols() + others.cols());
    both << shifts, others;
    return both;
  }
};

/// B with B B^T the covariance that features of a pose share.
/// @param effects, shifted  see SharedAxes
[[nodiscard]] inline Eigen::MatrixXd shared_columns(const Eigen::MatrixXd& effects,
                                                    const Eigen::MatrixXd& shifted,
                                                    const CommonNoise& common) {
  const SharedAxes axes(effects, shifted);
  Eigen::MatrixXd columns(effects.rows(), axes.shifts.cols() + axes.others.cols() + effects.cols());
  columns << common.shifts * axes.shifts, common.turns * axes.others, common.repeats * effects;
  return columns;
}

}  // namespace kinecal::detail
