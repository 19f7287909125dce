// Computing the design effect.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/design_effect.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "kinecal/solve/spectrum.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Sums over one sample, or over all.
struct GradientSums {
  Eigen::VectorXd together;  ///< gradient of all features of a sample
  Eigen::MatrixXd share;     ///< of the sample in the information
  double of_features = 0.0;  ///< squares of the gradients of single features
  double of_samples = 0.0;   ///< the same of whole samples
  double chance = 0.0;       ///< variance of of_samples if features err independently, relative

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
  /// Adds the sample and starts another one.
  void end_sample() {
    const Eigen::Index n = share.rows();
    // A direction that only this sample determines has no residual left and adds nothing.
    constexpr double kAlone = 1e-6;
    const Eigen::MatrixXd others = (1.0 + kAlone) * Eigen::MatrixXd::Identity(n, n) - share;
    of_samples += together.dot(others.ldlt().solve(together));
    chance += 2.0 * share.squaredNorm();
    together.setZero();
    share.setZero();
  }
};

}  // namespace
}  // namespace detail

double design_effect(const AnyProblem& problem, const LinearFit& fit) {
  const Eigen::Index n = fit.size();
  const detail::Spectrum spectrum(information(fit, fit.loss));
  const Eigen::Index rank = n - spectrum.null;
  if (rank == 0) return 1.0;
  const Eigen::MatrixXd whitening = spectrum.scale.cwiseInverse().asDiagonal() *
                                    spectrum.vectors.rightCols(rank) *
                                    spectrum.singular.tail(rank).cwiseInverse().asDiagonal();
  detail::GradientSums sums{Eigen::VectorXd::Zero(rank), Eigen::MatrixXd::Zero(rank, rank)};
  int sample = -1;
  double directions = 0.0;
  for (const RowBlock& block : fit.blocks) {
    if (block.sample != sample && sample >= 0) sums.end_sample();
    sample = block.sample;
    const Eigen::MatrixXd rows = fit.jacobian.middleRows(block.first, block.size) * whitening;
    const Eigen::VectorXd loss = fit.loss.segment(block.first, block.size);
    directions += (loss.asDiagonal() * rows).cwiseProduct(rows).sum();
    sums.add(rows, fit.residual.segment(block.first, block.size), loss,
             problem.term(block.term).feature_size);
  }
  if (sample >= 0) sums.end_sample();
  const double count = static_cast<double>(fit.residual.size());
  const double independent =
      sums.of_features * count / std::max(1.0, count - static_cast<double>(rank));
  if (!(independent > 0.0)) return 1.0;
  const double effect = sums.of_samples / independent;
  const double chance = std::sqrt(sums.chance) / directions;
  return effect > 1.0 + 3.0 * chance ? effect : 1.0;
}

}  // namespace kinecal
