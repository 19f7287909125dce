// Makes the rows of new samples independent, with variance one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/trust/drift.hpp"
#include "kinecal/trust/pose_rows.ipp"

namespace kinecal::detail {

/// Takes the noise that features of a pose share out of the rows of new samples.  Where the calibration
/// could not separate it, all features of a pose together count as one.
class Whitening {
 public:
  /// @param fit      rows in standard deviations of the features' own noise, derivatives by parameters
  /// @param effects  (rows x joints) see joint_effects()
  /// @param shifts   (rows x components) see feature_shifts()
  /// @param used     whether a sample is used; rows of others become zero
  Whitening(const AnyProblem& problem, const LinearFit& fit, const PoseGroups& poses,
            const CommonNoise& common, const Eigen::MatrixXd& effects,
            const Eigen::MatrixXd& shifts, const std::vector<bool>& used) {
    for (std::vector<std::size_t>& blocks : blocks_by_pose(fit, poses)) {
      std::erase_if(blocks, [&](std::size_t b) {
        const RowBlock& block = fit.blocks[b];
        const bool in = used[static_cast<std::size_t>(block.sample)];
        for (Eigen::Index i = 0; i < block.size && !in; ++i) unused_.push_back(block.first + i);
        return !in;
      });
      if (blocks.empty()) continue;
      const std::vector<Eigen::Index> rows = rows_of(fit, blocks);
      double features = 0.0;
      for (const std::size_t b : blocks) {
        const RowBlock& block = fit.blocks[b];
        features += static_cast<double>(block.size) / problem.term(block.term).feature_size;
      }
      const double weight = common.separable ? 1.0 : 1.0 / features;
      Pose pose{rows, SharedDirections(std::ssize(rows)), std::sqrt(weight)};
      if (common.is_shared()) {
        pose.shared = SharedDirections(
            shared_columns(effects(rows, Eigen::all), shifts(rows, Eigen::all), common));
        shared_ += static_cast<double>(pose.shared.sizes.size());
      }
      size_ += weight * static_cast<double>(std::ssize(rows));
      poses_.push_back(std::move(pose));
    }
  }

  /// Number of independent rows, and how many of them lie in shared directions.
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] double shared() const { return shared_; }

  /// Whitens rows.
  void apply(LinearFit& fit) const {
    fit.residual(unused_).setZero();
    fit.jacobian(unused_, Eigen::all).setZero();
    for (const Pose& pose : poses_) {
      const Eigen::MatrixXd j = fit.jacobian(pose.rows, Eigen::all);
      const Eigen::VectorXd r = fit.residual(pose.rows);
      fit.jacobian(pose.rows, Eigen::all) = pose.factor * pose.shared.whitened(j);
      fit.residual(pose.rows) = pose.factor * pose.shared.whitened(r);
    }
  }

 private:
  struct Pose {
    std::vector<Eigen::Index> rows;
    SharedDirections shared;
    double factor;
  };
  double size_ = 0.0, shared_ = 0.0;
  std::vector<Pose> poses_;
  std::vector<Eigen::Index> unused_;
};

}  // namespace kinecal::detail
