// Estimating noise that features of a pose share.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/common_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/trust/pose_rows.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The rows of a calibration at its solution, in standard deviations.
class PoseFit {
 public:
  PoseFit(const Eigen::MatrixXd& effects, const LinearFit& fit, const PoseGroups& poses,
          const std::vector<BlockNoise>& noise)
      : fit_(fit),
        effects_(effects),
        residual_(fit.residual),
        jacobian_(fit.jacobian),
        priors_(fit.prior_hessian / prior_variance(noise)) {
    for (const RowBlock& block : fit.blocks) {
      scale(block, 1.0 / noise[static_cast<std::size_t>(block.term)].weighted());
    }
    const Eigen::VectorXd root = fit.loss.cwiseSqrt();
    residual_.array() *= root.array();
    jacobian_ = root.asDiagonal() * jacobian_;
    poses_ = blocks_by_pose(fit, poses);
    std::erase_if(poses_, [](const auto& blocks) { return blocks.empty(); });
    effects_ = root.asDiagonal() * effects_;
    update();
  }

  /// Sums of squares outside the shared directions and their degrees of freedom, by error block.
  [[nodiscard]] std::vector<std::pair<double, double>> outside(std::size_t terms) const {
    std::vector<std::pair<double, double>> sums(terms);
    for (const auto& pose : poses_) {
      std::vector<std::vector<std::size_t>> by_term(terms);
      for (const std::size_t b : pose) {
        by_term[static_cast<std::size_t>(fit_.blocks[b].term)].push_back(b);
      }
      for (std::size_t t = 0; t < terms; ++t) {
        if (by_term[t].empty()) continue;
        const auto rows = rows_of(fit_, by_term[t]);
        const Eigen::VectorXd r = residual_(rows);
        const Eigen::MatrixXd j = jacobian_(rows, Eigen::all);
        const SharedDirections shared(effects_(rows, Eigen::all));
        sums[t].first += r.squaredNorm() - (shared.axes.transpose() * r).squaredNorm();
        const double leverage = (j * inverse_).cwiseProduct(j).sum() - leverages(shared, j).sum();
        sums[t].second += static_cast<double>(std::ssize(rows) - shared.sizes.size()) - leverage;
      }
    }
    return sums;
  }
  /// Divides the rows of an error block.
  void divide(int term, double by) {
    for (const RowBlock& block : fit_.blocks) {
      if (block.term == term) scale(block, 1.0 / by);
    }
    update();
  }
  /// Sets t and its degrees of freedom.
  /// @returns  variance of the features' own noise: one if it is known
  [[nodiscard]] double estimate(bool own_is_known, CommonNoise& common) const {
    std::vector<Eigen::Array3d> found;  // square / (1 - h), 1 - h, and l of each axis
    for (const auto& pose : poses_) {
      const auto rows = rows_of(fit_, pose);
      const SharedDirections shared(effects_(rows, Eigen::all));
      const Eigen::VectorXd along = shared.axes.transpose() * residual_(rows);
      const Eigen::VectorXd h = leverages(shared, jacobian_(rows, Eigen::all));
      for (Eigen::Index i = 0; i < h.size(); ++i) {
        const double left = std::max(0.05, 1.0 - h(i));
        found.emplace_back(along(i) * along(i) / left, left, shared.sizes(i));
        common.freedom += left;
      }
    }
    double own = 1.0, t2 = 0.0;
    constexpr int kRounds = 50;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
      Eigen::Vector2d right = Eigen::Vector2d::Zero();
      for (const Eigen::Array3d& axis : found) {
        const double variance = own + t2 * axis(2);
        const Eigen::Vector2d by(1.0, axis(2));
        matrix += axis(1) / (variance * variance) * by * by.transpose();
        right += axis(1) / (variance * variance) * axis(0) * by;
      }
      constexpr double kLeast = 1e-2;
      if (!own_is_known) own = std::max(kLeast, Ldlt(matrix).solve(Eigen::VectorXd(right))(0));
      t2 = matrix(1, 1) > 0.0 ? std::max(0.0, (right(1) - own * matrix(0, 1)) / matrix(1, 1)) : 0.0;
    }
    common.repeats = std::sqrt(t2);
    return own;
  }
  /// Sets how far the whitened residuals of poses differ from the model.
  void compare(CommonNoise& common) const {
    Eigen::MatrixXd information = priors_;
    std::vector<std::pair<Eigen::MatrixXd, Eigen::VectorXd>> whitened;
    for (const auto& pose : poses_) {
      const auto rows = rows_of(fit_, pose);
      const Eigen::MatrixXd j = jacobian_(rows, Eigen::all);
      const Eigen::VectorXd r = residual_(rows);
      const SharedDirections shared(effects_(rows, Eigen::all));
      whitened.emplace_back(shared.whitened(j, common.repeats), shared.whitened(r, common.repeats));
      information += whitened.back().first.transpose() * whitened.back().first;
    }
    const Eigen::MatrixXd inverse = Spectrum(information).pseudo_inverse();
    double scatter = 0.0, normal = 0.0, gradients = 0.0, expected = 0.0;
    for (const auto& [j, r] : whitened) {
      const Eigen::MatrixXd share = inverse * (j.transpose() * j);
      const double mean = static_cast<double>(r.size()) - share.trace();
      scatter += (r.squaredNorm() - mean) * (r.squaredNorm() - mean);
      const double squares = share.cwiseProduct(share.transpose()).sum();
      normal += 2.0 * (mean - share.trace() + squares);
      const Eigen::VectorXd g = j.transpose() * r;
      gradients += g.dot(inverse * g);
      expected += share.trace() - squares;
    }
    if (normal > 0.0) common.scatter = std::max(1.0, scatter / normal);
    if (expected > 0.0) common.effect = std::max(1.0, gradients / expected);
  }

 private:
  void scale(const RowBlock& block, double by) {
    residual_.segment(block.first, block.size) *= by;
    jacobian_.middleRows(block.first, block.size) *= by;
    effects_.middleRows(block.first, block.size) *= by;
  }
  void update() {
    inverse_ = Spectrum(jacobian_.transpose() * jacobian_ + priors_).pseudo_inverse();
  }
  [[nodiscard]] Eigen::VectorXd leverages(const SharedDirections& shared,
                                          const Eigen::MatrixXd& j) const {
    const Eigen::MatrixXd along = shared.axes.transpose() * j;
    return (along * inverse_).cwiseProduct(along).rowwise().sum();
  }

  const LinearFit& fit_;
  Eigen::MatrixXd effects_;  ///< (rows x joints) A
  Eigen::VectorXd residual_;
  LinearFit::RowMajor jacobian_;
  Eigen::MatrixXd priors_;                       ///< Hessian of the priors
  std::vector<std::vector<std::size_t>> poses_;  ///< blocks of each pose
  Eigen::MatrixXd inverse_;
};

}  // namespace
}  // namespace detail

CommonNoise common_noise(const LinearFit& fit, const Eigen::MatrixXd& effects,
                         const PoseGroups& poses, std::vector<BlockNoise>& noise) {
  CommonNoise common;
  for (const RowBlock& block : fit.blocks) {
    if (!(noise[static_cast<std::size_t>(block.term)].sigma > 0.0)) return common;
  }
  detail::PoseFit rows(effects, fit, poses, noise);
  const auto outside = rows.outside(noise.size());
  constexpr double kEnough = 5.0;
  for (std::size_t t = 0; t < noise.size(); ++t) {
    const auto& [squares, freedom] = outside[t];
    if (freedom < kEnough || !(squares > 0.0)) continue;
    common.separable = true;
    const double own = std::sqrt(squares / freedom);
    noise[t].own = own * noise[t].sigma;
    noise[t].own_freedom = freedom;
    rows.divide(static_cast<int>(t), own);
  }
  const double left = rows.estimate(common.separable, common);
  for (std::size_t t = 0; t < noise.size(); ++t) {
    const double before = noise[t].own_or_all();
    if (common.repeats == 0.0) {  // features err independently, so all rows show their noise
      noise[t].own = noise[t].sigma;
      noise[t].own_freedom = noise[t].freedom;
    } else if (!common.separable) {
      noise[t].own = std::sqrt(left) * noise[t].sigma;
      noise[t].own_freedom = noise[t].freedom;
    }
    rows.divide(static_cast<int>(t), noise[t].own_or_all() / before);
  }
  rows.compare(common);
  return common;
}

}  // namespace kinecal
