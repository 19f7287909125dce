// Residuals of a fit in which nothing is wrong: draws of the noise that its residuals show.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <vector>

#include "kinecal/trust/common_noise.hpp"
#include "kinecal/trust/noise.hpp"
#include "kinecal/trust/pose_rows.ipp"

namespace kinecal::detail {

/// Draws of residuals (I - J C J^T W) e, e the noise of features and of poses: see common_noise.hpp.
class NoiseDraws {
 public:
  /// @param effects  (rows x joints) see joint_effects()
  /// @param inverse  of J^T W J
  NoiseDraws(const LinearFit& fit, const PoseGroups& poses, const Eigen::MatrixXd& effects,
             const std::vector<BlockNoise>& noise, const CommonNoise& common,
             const Eigen::MatrixXd& inverse)
      : fit_(fit), inverse_(inverse), sigma_(fit.residual.size()) {
    std::vector<int> components;
    for (const BlockNoise& of : noise) components.push_back(of.components);
    for (const RowBlock& block : fit.blocks) {
      const BlockNoise& of = noise[static_cast<std::size_t>(block.term)];
      const auto loss = fit.loss.segment(block.first, block.size).array();
      sigma_.segment(block.first, block.size) =
          (loss > 0.0).select(of.own_or_all() / of.unit_sigma * loss.rsqrt(), 0.0);
    }
    const Eigen::VectorXd unit =
        sigma_.unaryExpr([](double sigma) { return sigma > 0.0 ? 1.0 / sigma : 0.0; });
    const Eigen::MatrixXd shifts = feature_shifts(fit, components);
    for (const auto& blocks : blocks_by_pose(fit, poses)) {
      if (blocks.empty()) continue;
      std::vector<Eigen::Index> rows = rows_of(fit, blocks);
      if (!common.is_shared()) {
        const auto count = std::ssize(rows);
        poses_.push_back({std::move(rows), Eigen::MatrixXd(count, 0)});
        continue;
      }
      Eigen::MatrixXd columns = shared_columns(
          unit(rows).asDiagonal() * effects(rows, Eigen::all),
          fit.loss(rows).cwiseSqrt().asDiagonal() * shifts(rows, Eigen::all), common);
      poses_.push_back({std::move(rows), std::move(columns)});
    }
  }

  /// (rows) weighted residuals.
  [[nodiscard]] Eigen::VectorXd draw(std::mt19937& random) const {
    std::normal_distribution<double> normal;
    const auto normals = [&](Eigen::Index count) {
      return Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(count, [&] { return normal(random); }));
    };
    Eigen::VectorXd errors(fit_.residual.size());
    for (const Pose& pose : poses_) {
      errors(pose.rows) =
          normals(std::ssize(pose.rows)) + pose.shared * normals(pose.shared.cols());
    }
    errors.array() *= sigma_.array();
    return errors - fit_.jacobian *
                        (inverse_ * (fit_.jacobian.transpose() * fit_.loss.cwiseProduct(errors)));
  }

 private:
  struct Pose {
    std::vector<Eigen::Index> rows;
    Eigen::MatrixXd shared;  ///< (rows x any)
  };

  const LinearFit& fit_;
  const Eigen::MatrixXd& inverse_;
  Eigen::VectorXd sigma_;  ///< (rows) of features, weighted
  std::vector<Pose> poses_;
};

}  // namespace kinecal::detail
