// Computing the variance of grouped gradients.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/gradient_variance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/noise/pose_rows.ipp"

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
  Eigen::MatrixXd influence;            ///< (free x coordinates) of a gradient on each parameter
  Eigen::VectorXd together;             ///< gradient of all features of a group
  Eigen::MatrixXd share;                ///< of the group in the information
  Eigen::VectorXd of_parameters;        ///< (free) of the group in the variance of each parameter
  Eigen::VectorXd sum, squares;         ///< (free) of those shares, over all groups
  std::vector<Eigen::VectorXd> groups;  ///< x of each group
  double of_features = 0.0;             ///< squares of the gradients of single features
  double chance = 0.0;  ///< variance of trace S if features err independently, relative

  explicit GradientSums(Eigen::MatrixXd of)
      : influence(std::move(of)),
        together(Eigen::VectorXd::Zero(influence.cols())),
        share(Eigen::MatrixXd::Zero(influence.cols(), influence.cols())),
        of_parameters(Eigen::VectorXd::Zero(influence.rows())),
        sum(of_parameters),
        squares(of_parameters) {}

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
    of_parameters.noalias() += (influence * rows.transpose()).cwiseAbs2() * loss;
  }
  /// Adds the group and starts another one.
  void end_group() {
    groups.push_back(restored(share, together));
    chance += 2.0 * share.squaredNorm();
    sum += of_parameters;
    squares += of_parameters.cwiseAbs2();
    together.setZero();
    share.setZero();
    of_parameters.setZero();
  }
  /// S.
  [[nodiscard]] Eigen::MatrixXd scatter() const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(influence.cols(), influence.cols());
    for (const Eigen::VectorXd& x : groups) all.noalias() += x * x.transpose();
    return all;
  }
};

/// S, shrunk towards a target as far as the scatter of the variances of the parameters demands.
[[nodiscard]] Eigen::MatrixXd shrunk(const GradientSums& sums, const Eigen::MatrixXd& target) {
  const Eigen::MatrixXd scatter = sums.scatter(), &of = sums.influence;
  const auto variances = [&](const Eigen::MatrixXd& matrix) {
    return Eigen::ArrayXd((of * matrix).cwiseProduct(of).rowwise().sum().array());
  };
  const Eigen::ArrayXd found = variances(scatter), expected = variances(target);
  double apart = 0.0, chance = 0.0;
  for (Eigen::Index p = 0; p < found.size(); ++p) {
    if (!(expected(p) > 0.0) || !(sums.sum(p) > 0.0)) continue;
    const double by = found(p) / expected(p) - 1.0;
    apart += by * by;
    chance += 2.0 * sums.squares(p) / (sums.sum(p) * sums.sum(p));
  }
  if (!(apart > chance)) return target;
  const double weight = chance / apart;  // of the target
  return weight * target + (1.0 - weight) * scatter;
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
  detail::GradientSums sums(fit.coordinates.basis * whitening);
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
  return {back * detail::shrunk(sums, effect * of_rows) * back.transpose() + of_priors, effect};
}

}  // namespace kinecal
