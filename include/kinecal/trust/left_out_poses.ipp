// Whether a column beside those of a fit is more than chance, by fits without each pose in turn (jackknife).
//
//   variance = (n - 1) / n sum (a_i - mean a)^2      a_i the column's coefficient without pose i
//
// Rows of a pose may err together in any way.  The degrees of freedom are those of the poses that count: (sum e)^2 / sum e^2,
// e the column's own effect in each, less one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/pose_rows.ipp"

namespace kinecal::detail {

/// A column's coefficient and the probability that it is as large by chance.
struct ColumnTest {
  double change = 0.0;
  double chance = 1.0;
};

/// Tests the first of some columns beside those of a fit and the other ones.
/// @param added  (rows x columns) derivatives of the weighted residuals
[[nodiscard]] inline ColumnTest test_column(const LinearFit& fit, const Eigen::MatrixXd& added,
                                            const PoseGroups& poses) {
  constexpr double kOwn = 1e-3, kRidge = 1e-10, kAlike = 0.01;
  constexpr std::size_t kFewest = 6;
  const Eigen::Index own = fit.size(), all = own + added.cols();
  Eigen::MatrixXd rows(fit.residual.size(), all);
  rows << fit.jacobian, added;
  Eigen::MatrixXd sums = rows.transpose() * fit.loss.asDiagonal() * rows;
  sums.topLeftCorner(own, own) += fit.prior_hessian;
  Eigen::VectorXd gradient = rows.transpose() * fit.loss.cwiseProduct(fit.residual);
  gradient.head(own) += fit.prior_gradient;
  const Eigen::VectorXd scale = sums.diagonal().unaryExpr(
      [](double square) { return square > 0.0 ? 1.0 / std::sqrt(square) : 0.0; });
  rows = rows * scale.asDiagonal();
  sums = scale.asDiagonal() * sums * scale.asDiagonal();
  sums.diagonal().array() += kRidge;
  gradient = scale.cwiseProduct(gradient);
  const Ldlt by_own(sums.topLeftCorner(own, own));
  for (Eigen::Index c = own + 1; c < all;
       ++c) {  // what the fit has: beside it, only residuals are left
    const Eigen::VectorXd cross = sums.col(c).head(own);
    if (1.0 - cross.dot(by_own.solve(cross)) > kAlike) continue;
    rows.col(c).setZero();
    sums.row(c).setZero();
    sums.col(c).setZero();
    sums(c, c) = 1.0;
    gradient(c) = 0.0;
  }
  const Eigen::VectorXd of_first =
      Ldlt(sums).solve(Eigen::VectorXd(Eigen::VectorXd::Unit(all, own)));  // column of the inverse
  auto by_pose = blocks_by_pose(fit, poses);
  std::erase_if(by_pose, [&](const std::vector<std::size_t>& blocks) {
    return std::all_of(blocks.begin(), blocks.end(), [&](std::size_t b) {
      return added.middleRows(fit.blocks[b].first, fit.blocks[b].size).isZero(0.0);
    });
  });
  const auto n = static_cast<double>(by_pose.size());
  if (by_pose.size() < kFewest || !(of_first(own) > 0.0) || 1.0 / of_first(own) < kOwn) return {};
  Eigen::VectorXd changes(std::ssize(by_pose)), effects(std::ssize(by_pose));
  for (std::size_t pose = 0; pose < by_pose.size(); ++pose) {
    Eigen::MatrixXd others = sums;
    Eigen::VectorXd of_others = gradient;
    double effect = 0.0;
    for (const std::size_t b : by_pose[pose]) {
      const RowBlock& block = fit.blocks[b];
      const auto of = rows.middleRows(block.first, block.size);
      const auto loss = fit.loss.segment(block.first, block.size);
      others -= of.transpose() * loss.asDiagonal() * of;
      of_others -=
          of.transpose() * loss.cwiseProduct(fit.residual.segment(block.first, block.size));
      effect += (of * of_first).cwiseAbs2().dot(loss);
    }
    const auto at = static_cast<Eigen::Index>(pose);
    changes(at) = -Ldlt(others).solve(of_others)(own);
    effects(at) = effect;
  }
  const double variance = (n - 1.0) / n * (changes.array() - changes.mean()).square().sum();
  const double change = -of_first.dot(gradient);
  const double freedom = effects.sum() * effects.sum() / effects.squaredNorm() - 1.0;
  if (!(variance > 0.0) || !(freedom > 0.0)) return {};
  return {scale(own) * change, f_tail(change * change / variance, 1.0, freedom)};
}

}  // namespace kinecal::detail
