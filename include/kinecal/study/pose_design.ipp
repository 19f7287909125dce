// The criterion of a set of poses, for select_poses.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "kinecal/study/select_poses.hpp"

namespace kinecal::detail {

/// The contribution of some poses: H and V.
struct DesignSums {
  Eigen::MatrixXd information, scores;

  [[nodiscard]] DesignSums plus(const DesignSums& other) const {
    return {information + other.information, scores + other.scores};
  }
  [[nodiscard]] DesignSums minus(const DesignSums& other) const {
    return {information - other.information, scores - other.scores};
  }
};

/// Candidates in coordinates in which their total information is the identity.  There, a criterion
/// needs one Cholesky decomposition, and undetermined directions have no coordinate.
class PoseDesign {
 public:
  PoseDesign(const PoseCandidates& candidates, PoseCriterion criterion) : criterion_(criterion) {
    if (candidates.information.empty()) throw std::invalid_argument("there are no poses to choose");
    const bool has_scores = !candidates.scores.empty();
    if (has_scores && candidates.scores.size() != candidates.information.size()) {
      throw std::invalid_argument("not every pose has its scores");
    }
    const Eigen::Index n = candidates.information[0].rows();
    before_.information = checked(candidates.before, n, true);
    before_.scores = has_scores ? checked(candidates.before_scores, n, true) : before_.information;
    const Eigen::MatrixXd prior = checked(candidates.prior, n, true);
    Eigen::MatrixXd all = before_.information;
    for (std::size_t i = 0; i < candidates.information.size(); ++i) {
      DesignSums of;
      of.information = checked(candidates.information[i], n, false) + prior;
      of.scores = has_scores ? checked(candidates.scores[i], n, false) : of.information;
      all += of.information;
      poses_.push_back(std::move(of));
    }
    set_coordinates(all, checked(candidates.goal, n, criterion != PoseCriterion::gripper));
  }

  [[nodiscard]] int size() const { return static_cast<int>(poses_.size()); }
  /// The sums of no pose.
  [[nodiscard]] const DesignSums& nothing() const { return before_; }
  [[nodiscard]] const DesignSums& of(int pose) const {
    return poses_[static_cast<std::size_t>(pose)];
  }
  [[nodiscard]] DesignSums sum(const std::vector<int>& chosen) const {
    DesignSums total = before_;
    for (const int pose : chosen) total = total.plus(of(pose));
    return total;
  }

  /// The criterion of some sums.
  /// @param little  share of all candidates' information, added while a set does not determine
  ///                everything
  [[nodiscard]] double value(const DesignSums& sums, double little = 0.0) const {
    DesignSums total = sums;
    total.information.diagonal().array() += little;
    total.scores.diagonal().array() += little * mean_score_;
    const Eigen::LLT<Eigen::MatrixXd> llt(total.information);
    constexpr double kLeast = 1e-13;  // of all candidates' information: less is rounding
    const double infinite = std::numeric_limits<double>::infinity();
    if (llt.info() != Eigen::Success) return infinite;
    const auto pivots = llt.matrixLLT().diagonal();
    if (pivots.size() > 0 && pivots.cwiseAbs2().minCoeff() < kLeast) return infinite;
    const Eigen::MatrixXd half = llt.solve(total.scores);
    const Eigen::MatrixXd covariance = llt.solve(half.transpose());
    if (criterion_ == PoseCriterion::gripper) return goal_.cwiseProduct(covariance).sum();
    const Eigen::MatrixXd scaled = units_ * covariance * units_.transpose();
    if (criterion_ == PoseCriterion::a) return scaled.trace();
    if (criterion_ == PoseCriterion::e) {
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
          .eigenvalues()
          .maxCoeff();
    }
    const Eigen::LLT<Eigen::MatrixXd> volume(covariance);
    if (volume.info() != Eigen::Success) return infinite;
    return 2.0 * volume.matrixLLT().diagonal().array().log().sum();
  }

 private:
  [[nodiscard]] static Eigen::MatrixXd checked(const PlainMatrix& of, Eigen::Index n,
                                               bool may_be_empty) {
    Eigen::MatrixXd matrix = of.matrix();
    if (matrix.size() == 0 && may_be_empty) return Eigen::MatrixXd::Zero(n, n);
    if (matrix.rows() != n || matrix.cols() != n) {
      throw std::invalid_argument("the information of poses and the goal are not of one size");
    }
    if (!matrix.allFinite()) throw std::invalid_argument("the information of a pose is not finite");
    return matrix;
  }

  /// Changes to coordinates in which this is the identity.
  void set_coordinates(const Eigen::MatrixXd& all, const Eigen::MatrixXd& goal) {
    const Eigen::Index n = all.rows();
    const Eigen::VectorXd units =
        all.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 1.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(units.asDiagonal() * all *
                                                                units.asDiagonal());
    constexpr double kNothing = 1e-11;  // of the largest eigenvalue
    Eigen::Index lost = 0;
    while (lost < n && solver.eigenvalues()(lost) <= kNothing * solver.eigenvalues()(n - 1)) ++lost;
    units_ = solver.eigenvectors().rightCols(n - lost) *
             solver.eigenvalues().tail(n - lost).cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd basis = units.asDiagonal() * units_;
    const auto change = [&](DesignSums& sums) {
      sums.information = basis.transpose() * sums.information * basis;
      sums.scores = basis.transpose() * sums.scores * basis;
    };
    change(before_);
    double scores = before_.scores.trace();
    for (DesignSums& of : poses_) {
      change(of);
      scores += of.scores.trace();
    }
    mean_score_ = scores / static_cast<double>(std::max<Eigen::Index>(1, n - lost));
    goal_ = basis.transpose() * goal * basis;
  }

  PoseCriterion criterion_;
  DesignSums before_;
  std::vector<DesignSums> poses_;
  Eigen::MatrixXd goal_, units_;
  double mean_score_ = 1.0;
};

}  // namespace kinecal::detail
