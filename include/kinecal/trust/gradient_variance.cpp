// Computing the variance of grouped gradients.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/gradient_variance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/pose_rows.ipp"

namespace kinecal {

namespace detail {
namespace {

/// (I - M)^-1/2 g.  A direction that only this group determines has no residual left and adds nothing.
[[nodiscard]] Eigen::VectorXd restored(const Eigen::MatrixXd& share, const Eigen::VectorXd& g) {
  constexpr double kSmall = 0.1;
  if (share.trace() < kSmall) {  // its power series
    const Eigen::VectorXd first = share * g, second = share * first, third = share * second;
    return g + 0.5 * first + 0.375 * second + 0.3125 * third;
  }
  const Eigenpairs spectrum = eigenpairs(share);
  constexpr double kAlone = 1e-6;
  const Eigen::ArrayXd factor = (1.0 + kAlone - spectrum.values.array()).max(kAlone).rsqrt();
  return spectrum.vectors * (factor * (spectrum.vectors.transpose() * g).array()).matrix();
}

/// Sums over one group, and over all.
struct GradientSums {
  Eigen::VectorXd together;             ///< gradient of all features of a group
  Eigen::MatrixXd share;                ///< of the group in the information
  std::vector<Eigen::VectorXd> groups;  ///< x of each group
  double of_features = 0.0;             ///< squares of the gradients of single features
  double chance = 0.0;  ///< variance of trace S if features err independently, relative

  /// @param rows  derivatives of a block's residuals, in whitened coordinates
  /// @param size  residuals of a feature
  void add(const Eigen::MatrixXd& rows, const Eigen::VectorXd& residual,
           const Eigen::VectorXd& loss, int size) {
    const Eigen::VectorXd weighted = loss.cwiseProduct(residual);
    for (Eigen::Index row = 0; row < rows.rows(); row += size) {
      const Eigen::VectorXd of_feature =
          rows.middleRows(row, size).transpose() * weighted.segment(row, size);
      of_features += of_feature.squaredNorm();
    }
    together.noalias() += rows.transpose() * weighted;
    share.noalias() += rows.transpose() * loss.asDiagonal() * rows;
  }
  /// Adds the group and starts another one.
  void end_group() {
    groups.push_back(restored(share, together));
    chance += 2.0 * share.squaredNorm();
    together.setZero();
    share.setZero();
  }
};

/// S, shrunk towards a target as far as its own scatter demands.
[[nodiscard]] Eigen::MatrixXd shrunk(const std::vector<Eigen::VectorXd>& groups,
                                     const Eigen::MatrixXd& target) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(target.rows(), target.cols());
  double fourth = 0.0;
  for (const Eigen::VectorXd& x : groups) {
    sum.noalias() += x * x.transpose();
    fourth += x.squaredNorm() * x.squaredNorm();
  }
  const double scatter = fourth - sum.squaredNorm() / static_cast<double>(groups.size());
  const double distance = (sum - target).squaredNorm();
  const double weight = distance > scatter ? scatter / distance : 1.0;  // of the target
  return weight * target + (1.0 - weight) * sum;
}

}  // namespace
}  // namespace detail

GradientVariance gradient_variance(const AnyProblem& problem, const LinearFit& fit,
                                   const PoseGroups& poses, const Eigen::MatrixXd& independent,
                                   const Eigen::MatrixXd& of_priors) {
  const Eigen::Index n = fit.size();
  const detail::Spectrum spectrum(information(fit, fit.loss));
  const Eigen::Index rank = n - spectrum.null;
  if (rank == 0) return {independent};
  const Eigen::MatrixXd whitening = spectrum.scale.cwiseInverse().asDiagonal() *
                                    spectrum.vectors.rightCols(rank) *
                                    spectrum.singular.tail(rank).cwiseInverse().asDiagonal();
  detail::GradientSums sums{Eigen::VectorXd::Zero(rank), Eigen::MatrixXd::Zero(rank, rank), {}};
  double directions = 0.0;
  for (const std::vector<std::size_t>& of_pose : detail::blocks_by_pose(fit, poses)) {
    for (const std::size_t b : of_pose) {
      const RowBlock& block = fit.blocks[b];
      const Eigen::MatrixXd rows = fit.jacobian.middleRows(block.first, block.size) * whitening;
      const Eigen::VectorXd loss = fit.loss.segment(block.first, block.size);
      directions += (loss.asDiagonal() * rows).cwiseProduct(rows).sum();
      sums.add(rows, fit.residual.segment(block.first, block.size), loss,
               problem.term(block.term).feature_size);
    }
    if (!of_pose.empty()) sums.end_group();
  }
  if (sums.groups.empty()) return {independent};
  const double count = static_cast<double>(fit.residual.size());
  const double of_features =
      sums.of_features * count / std::max(1.0, count - static_cast<double>(rank));
  if (!(of_features > 0.0)) return {independent};
  double of_groups = 0.0;
  for (const Eigen::VectorXd& x : sums.groups) of_groups += x.squaredNorm();
  double effect = of_groups / of_features;
  const double chance = std::sqrt(sums.chance) / directions;
  if (effect <= 1.0 + 3.0 * chance) effect = 1.0;
  const Eigen::MatrixXd back = spectrum.scale.asDiagonal() * spectrum.vectors.rightCols(rank) *
                               spectrum.singular.tail(rank).asDiagonal();
  const Eigen::MatrixXd of_rows = whitening.transpose() * (independent - of_priors) * whitening;
  return {back * detail::shrunk(sums.groups, effect * of_rows) * back.transpose() + of_priors,
          effect};
}

}  // namespace kinecal
