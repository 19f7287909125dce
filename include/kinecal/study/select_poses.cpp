// Definitions of select_poses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/select_poses.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal {

namespace detail {
namespace {

// The criterion of a set of poses.

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

/// A search for poses.
class BestPoses {
 public:
  BestPoses(const PoseCandidates& candidates, const SelectOptions& options)
      : design_(candidates, options.criterion), shares_(candidates.shares), options_(options) {
    if (!shares_.empty() && shares_.size() != candidates.information.size()) {
      throw std::invalid_argument("not every pose has its joints");
    }
  }

  [[nodiscard]] PoseSelection run() {
    std::vector<int> chosen = greedy(all(), options_.count, "selecting poses");
    exchange(chosen);
    PoseSelection selection;
    selection.chosen = greedy(chosen, static_cast<int>(chosen.size()), "ordering poses");
    DesignSums sum = design_.nothing();
    for (const int pose : selection.chosen) {
      sum = sum.plus(design_.of(pose));
      selection.values.push_back(design_.value(sum));
    }
    selection.value = value_after_failures(selection.chosen);
    return selection;
  }

 private:
  static constexpr double kLittle = 1e-6;  ///< of all candidates' information

  [[nodiscard]] std::vector<int> all() const {
    std::vector<int> every(static_cast<std::size_t>(design_.size()));
    std::iota(every.begin(), every.end(), 0);
    return every;
  }

  [[nodiscard]] bool are_alike(int a, int b) const {
    if (shares_.empty()) return false;
    const auto &of_a = shares_[static_cast<std::size_t>(a)],
               &of_b = shares_[static_cast<std::size_t>(b)];
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      if (std::abs(of_a[i] - of_b[i]) > options_.least_distance) return false;
    }
    return true;
  }
  /// True if a pose may join some others when one of them leaves.
  [[nodiscard]] bool may_join(int pose, const std::vector<int>& others, int leaves) const {
    return std::none_of(others.begin(), others.end(), [&](int other) {
      return other != leaves && (other == pose || are_alike(other, pose));
    });
  }

  void report(std::size_t done, std::size_t of, const std::string& what) const {
    if (options_.meter) options_.meter(static_cast<double>(done) / static_cast<double>(of), what);
  }

  /// Adds the pose that helps most, again and again.
  [[nodiscard]] std::vector<int> greedy(const std::vector<int>& from, int count,
                                        const std::string& what) const {
    std::vector<int> chosen;
    DesignSums sum = design_.nothing();
    while (static_cast<int>(chosen.size()) < count) {
      report(chosen.size(), static_cast<std::size_t>(count), what);
      double least = std::numeric_limits<double>::infinity();
      int best = -1;
      for (const int pose : from) {
        if (!may_join(pose, chosen, -1)) continue;
        const double value = design_.value(sum.plus(design_.of(pose)), kLittle);
        if (best >= 0 && !(value < least)) continue;
        best = pose;
        least = value;
      }
      if (best < 0) break;
      chosen.push_back(best);
      sum = sum.plus(design_.of(best));
    }
    return chosen;
  }

  /// The value without the poses that the set would miss most.
  [[nodiscard]] double value_after_failures(std::vector<int> chosen) const {
    DesignSums sum = design_.sum(chosen);
    double value = design_.value(sum, kLittle);
    for (int failure = 0; failure < options_.failures && !chosen.empty(); ++failure) {
      std::size_t missed = 0;
      double most = -std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        const double without = design_.value(sum.minus(design_.of(chosen[i])), kLittle);
        if (!(without > most)) continue;
        most = without;
        missed = i;
      }
      sum = sum.minus(design_.of(chosen[missed]));
      chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(missed));
      value = most;
    }
    return value;
  }

  [[nodiscard]] double value_of(const std::vector<int>& chosen, const DesignSums& sum) const {
    return options_.failures > 0 ? value_after_failures(chosen) : design_.value(sum, kLittle);
  }

  /// Exchanges chosen poses for others while that helps.
  void exchange(std::vector<int>& chosen) const {
    constexpr double kHelps = 1e-6;  // of the value
    constexpr int kRounds = 50;
    DesignSums sum = design_.sum(chosen);
    double least = value_of(chosen, sum);
    bool improved = true;
    for (int round = 0; round < kRounds && improved; ++round) {
      improved = false;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        report(i, chosen.size(), "exchanging poses, round " + std::to_string(round + 1));
        const int leaves = chosen[i];
        const DesignSums others = sum.minus(design_.of(leaves));
        int best = leaves;
        for (int pose = 0; pose < design_.size(); ++pose) {
          if (!may_join(pose, chosen, leaves) || pose == leaves) continue;
          chosen[i] = pose;
          const double value = value_of(chosen, others.plus(design_.of(pose)));
          if (!(least - value > kHelps * std::abs(least))) continue;
          least = value;
          best = pose;
        }
        chosen[i] = best;
        sum = others.plus(design_.of(best));
        improved = improved || best != leaves;
      }
    }
  }

  PoseDesign design_;
  const std::vector<std::vector<double>>& shares_;
  SelectOptions options_;
};

}  // namespace
}  // namespace detail

PoseSelection select_poses(const PoseCandidates& candidates, const SelectOptions& options) {
  return detail::BestPoses(candidates, options).run();
}

PlainMatrix goal_of_parameters(const PoseCandidates& candidates, const std::vector<int>& columns) {
  if (candidates.information.empty()) throw std::invalid_argument("there are no poses to choose");
  const Eigen::Index n = candidates.information.front().rows();
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(n, n), goal = mean;
  for (const PlainMatrix& of : candidates.information) {
    mean += of.matrix() / static_cast<double>(candidates.information.size());
  }
  for (const int column : columns) goal(column, column) = mean(column, column);
  return goal;
}

double design_value(const PoseCandidates& candidates, const std::vector<int>& chosen,
                    PoseCriterion criterion) {
  const detail::PoseDesign design(candidates, criterion);
  return design.value(design.sum(chosen));
}

RandomSets random_sets(const PoseCandidates& candidates, int count, int sets,
                       PoseCriterion criterion, std::uint64_t seed) {
  const detail::PoseDesign design(candidates, criterion);
  SeededRandom random(seed);
  std::vector<int> all(static_cast<std::size_t>(design.size()));
  std::iota(all.begin(), all.end(), 0);
  RandomSets result;
  double least = std::numeric_limits<double>::infinity();
  const int size = std::min(count, design.size());
  for (int set = 0; set < sets; ++set) {
    for (int i = 0; i < size; ++i) {
      std::swap(all[static_cast<std::size_t>(i)],
                all[static_cast<std::size_t>(random.integer(i, design.size() - 1))]);
    }
    const std::vector<int> chosen(all.begin(), all.begin() + size);
    const double value = design.value(design.sum(chosen));
    result.values.push_back(value);
    if (result.best.empty() || value < least) result.best = chosen;
    least = std::min(least, value);
  }
  std::sort(result.values.begin(), result.values.end());
  return result;
}

}  // namespace kinecal
