// Estimating noise that features of a pose share.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/common_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/trust/noise/pose_rows.ipp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] std::vector<int> components_of(const std::vector<BlockNoise>& noise) {
  std::vector<int> all;
  for (const BlockNoise& block : noise) all.push_back(block.components);
  return all;
}

/// The residuals of a pose along its shared directions, Q first, then R.
struct PoseSums {
  using Parts = std::array<Eigen::MatrixXd, 4>;  // (axes x axes) factors of own, s^2, w^2, t^2
  Eigen::Index shifts = 0;                       ///< number of axes of Q
  Eigen::VectorXd along;                         ///< (axes) residuals
  Parts model;                                   ///< their covariance, of errors
  Parts fitted;                                  ///< the same of residuals

  /// Traces of the blocks of Q and of R of a matrix.
  [[nodiscard]] Eigen::Array2d traces(const Eigen::MatrixXd& of) const {
    const double first = of.diagonal().head(shifts).sum();
    return {first, of.trace() - first};
  }
  /// The whitened sum of squares minus its mean.
  /// @param variances  own, s^2, w^2, t^2
  [[nodiscard]] double whitened_excess(const Eigen::Vector4d& variances) const {
    const auto sum = [&](const Parts& parts) {
      Eigen::MatrixXd all = variances(0) * parts[0];
      for (Eigen::Index k = 1; k < 4; ++k) all += variances(k) * parts[static_cast<std::size_t>(k)];
      return all;
    };
    const Ldlt factor(sum(model));
    return along.dot(factor.solve(along)) - factor.solve(sum(fitted)).trace();
  }
};

/// Variances that reproduce what poses show.
class SharedVariances {
 public:
  /// @param own_is_known  own noise is one; else all but t is part of it
  SharedVariances(std::vector<PoseSums> poses, bool own_is_known)
      : poses_(std::move(poses)), own_is_known_(own_is_known) {
    for (const PoseSums& pose : poses_) {
      left_ += pose.traces(pose.along * pose.along.transpose());
      for (Eigen::Index k = 0; k < 4; ++k) {
        means_.col(k) += pose.traces(pose.fitted[static_cast<std::size_t>(k)]);
      }
    }
    if (own_is_known_) left_ -= means_.col(0);
  }
  [[nodiscard]] double freedom() const { return means_.col(0).sum(); }

  /// Own, s^2, w^2, t^2.  The plain sums leave a line of them; t is the largest on it at which the
  /// whitened sum is not above its mean, else that at which it is nearest.
  [[nodiscard]] Eigen::Vector4d found() const {
    const double of_joints = means_.col(3).sum();
    if (!(left_.sum() > 0.0)) return with(0.0);
    constexpr int kSteps = 40;
    constexpr double kStep = 0.85;
    double t2 = of_joints > 0.0 ? left_.sum() / of_joints : 0.0, best = 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kSteps && least > 0.0; ++i, t2 *= kStep) {
      const Eigen::Vector4d variances = with(t2);
      double excess = 0.0;
      for (const PoseSums& pose : poses_) excess += pose.whitened_excess(variances);
      if (excess >= least) continue;
      least = excess;
      best = t2;
    }
    return with(best);
  }

 private:
  /// Those with this t^2 that reproduce the plain sums: along Q and R, or along both together where
  /// one of them would be negative.
  [[nodiscard]] Eigen::Vector4d with(double t2) const {
    const Eigen::Array2d rest = left_ - t2 * means_.col(3);
    if (!own_is_known_) {
      constexpr double kLeast = 1e-2;  // of the variance of all noise
      return {std::max(kLeast, rest.sum() / freedom()), 0.0, 0.0, t2};
    }
    const Eigen::Matrix2d by = means_.block<2, 2>(0, 1).matrix();
    const bool has_both = by.determinant() > 0.0;
    Eigen::Vector2d found =
        has_both ? Eigen::Vector2d(by.inverse() * rest.matrix()) : Eigen::Vector2d(0.0, -1.0);
    if (found.minCoeff() < 0.0) {
      const Eigen::Index kept = found(0) < 0.0 ? 1 : 0;
      found.setZero();
      found(kept) = std::max(0.0, rest.sum() / by.col(kept).sum());
    }
    return {1.0, found(0), found(1), t2};
  }

  std::vector<PoseSums> poses_;
  bool own_is_known_;
  Eigen::Array2d left_ = Eigen::Array2d::Zero();  ///< sums of squares along Q and R
  Eigen::Array<double, 2, 4> means_ = Eigen::Array<double, 2, 4>::Zero();  ///< of them
};

/// The rows of a calibration at its solution, in standard deviations.
class PoseFit {
 public:
  PoseFit(const Eigen::MatrixXd& effects, const LinearFit& fit, const PoseGroups& poses,
          const std::vector<BlockNoise>& noise)
      : fit_(fit),
        effects_(effects),
        shifts_(fit.loss.cwiseSqrt().asDiagonal() * feature_shifts(fit, components_of(noise))),
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
        const Eigen::MatrixXd axes = axes_of(rows).all();
        sums[t].first += r.squaredNorm() - (axes.transpose() * r).squaredNorm();
        sums[t].second += static_cast<double>(std::ssize(rows) - axes.cols()) - leverage(j) +
                          leverage(axes.transpose() * j);
      }
    }
    return sums;
  }
  /// Divides the rows of each error block.
  void divide(const std::vector<double>& by) {
    for (const RowBlock& block : fit_.blocks) {
      scale(block, 1.0 / by[static_cast<std::size_t>(block.term)]);
    }
  }
  /// Sets what poses share.
  /// @returns  variance of the features' own noise: one if it is known
  [[nodiscard]] double estimate(bool own_is_known, CommonNoise& common) {
    update();
    const SharedVariances variances(pose_sums(), own_is_known);
    const Eigen::Vector4d found = variances.found();
    common.freedom = variances.freedom();
    common.shifts = std::sqrt(found(1));
    common.turns = std::sqrt(found(2));
    common.repeats = std::sqrt(found(3));
    return found(0);
  }
  /// Sets how far the whitened gradients of poses differ from the model.
  void compare(CommonNoise& common) const {
    Eigen::MatrixXd information = priors_;
    std::vector<std::pair<Eigen::MatrixXd, Eigen::VectorXd>> whitened;
    for (const auto& pose : poses_) {
      const auto rows = rows_of(fit_, pose);
      const SharedDirections shared(
          shared_columns(effects_(rows, Eigen::all), shifts_(rows, Eigen::all), common));
      whitened.emplace_back(shared.whitened(Eigen::MatrixXd(jacobian_(rows, Eigen::all))),
                            shared.whitened(Eigen::VectorXd(residual_(rows))));
      information += whitened.back().first.transpose() * whitened.back().first;
    }
    const Eigen::MatrixXd inverse = Spectrum(information).pseudo_inverse();
    double gradients = 0.0, expected = 0.0;
    for (const auto& [j, r] : whitened) {
      const Eigen::MatrixXd share = inverse * (j.transpose() * j);
      const Eigen::VectorXd g = j.transpose() * r;
      gradients += g.dot(inverse * g);
      expected += share.trace() - share.cwiseProduct(share.transpose()).sum();
    }
    if (expected > 0.0) common.effect = std::max(1.0, gradients / expected);
  }

 private:
  [[nodiscard]] SharedAxes axes_of(const std::vector<Eigen::Index>& rows) const {
    return {effects_(rows, Eigen::all), shifts_(rows, Eigen::all)};
  }
  [[nodiscard]] std::vector<PoseSums> pose_sums() const {
    std::vector<PoseSums> all;
    std::vector<Eigen::MatrixXd> slopes;  // U^T J
    PoseSums::Parts sums;                 // J^T S J
    sums.fill(Eigen::MatrixXd::Zero(jacobian_.cols(), jacobian_.cols()));
    sums[0] = information_;
    for (const auto& pose : poses_) {
      const auto rows = rows_of(fit_, pose);
      const SharedAxes axes = axes_of(rows);
      const Eigen::MatrixXd along = axes.all().transpose();
      const Eigen::MatrixXd joints = along * effects_(rows, Eigen::all);
      Eigen::VectorXd in_shifts = Eigen::VectorXd::Zero(along.rows());
      in_shifts.head(axes.shifts.cols()).setOnes();
      PoseSums& of = all.emplace_back();
      of.shifts = axes.shifts.cols();
      of.along = along * residual_(rows);
      of.model = {Eigen::MatrixXd::Identity(along.rows(), along.rows()), in_shifts.asDiagonal(),
                  Eigen::VectorXd(1.0 - in_shifts.array()).asDiagonal(),
                  joints * joints.transpose()};
      const Eigen::MatrixXd& j = slopes.emplace_back(along * jacobian_(rows, Eigen::all));
      for (std::size_t k = 1; k < 4; ++k) sums[k] += j.transpose() * of.model[k] * j;
    }
    for (std::size_t i = 0; i < all.size(); ++i) {  // of r - J H^-1 J^T r
      const Eigen::MatrixXd b = inverse_ * slopes[i].transpose(), h = slopes[i] * b;
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::MatrixXd taken = h * all[i].model[k];
        all[i].fitted[k] =
            all[i].model[k] - taken - taken.transpose() + b.transpose() * sums[k] * b;
      }
    }
    return all;
  }
  void scale(const RowBlock& block, double by) {
    residual_.segment(block.first, block.size) *= by;
    jacobian_.middleRows(block.first, block.size) *= by;
    effects_.middleRows(block.first, block.size) *= by;
  }
  /// After divide().
  void update() {
    information_ = jacobian_.transpose() * jacobian_ + priors_;
    inverse_ = Spectrum(information_).pseudo_inverse();
  }
  [[nodiscard]] double leverage(const Eigen::MatrixXd& j) const {
    return (j * inverse_).cwiseProduct(j).sum();
  }

  const LinearFit& fit_;
  Eigen::MatrixXd effects_;  ///< (rows x joints) A
  Eigen::MatrixXd shifts_;   ///< (rows x components) Q
  Eigen::VectorXd residual_;
  LinearFit::RowMajor jacobian_;
  Eigen::MatrixXd priors_;                       ///< Hessian of the priors
  std::vector<std::vector<std::size_t>> poses_;  ///< blocks of each pose
  Eigen::MatrixXd information_, inverse_;
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
  std::vector<double> by(noise.size(), 1.0);
  for (std::size_t t = 0; t < noise.size(); ++t) {
    const auto& [squares, freedom] = outside[t];
    if (freedom < kEnough || !(squares > 0.0)) continue;
    common.separable = true;
    const double own = std::sqrt(squares / freedom);
    noise[t].own = own * noise[t].sigma;
    noise[t].own_freedom = freedom;
    by[t] = own;
  }
  rows.divide(by);
  const double left = rows.estimate(common.separable, common);
  for (std::size_t t = 0; t < noise.size(); ++t) {
    const double before = noise[t].own_or_all();
    if (!common.is_shared()) {  // features err independently, so all rows show their noise
      noise[t].own = noise[t].sigma;
      noise[t].own_freedom = noise[t].freedom;
    } else if (!common.separable) {
      noise[t].own = std::sqrt(left) * noise[t].sigma;
      noise[t].own_freedom = noise[t].freedom;
    }
    by[t] = noise[t].own_or_all() / before;
  }
  rows.divide(by);
  rows.compare(common);
  return common;
}

}  // namespace kinecal
