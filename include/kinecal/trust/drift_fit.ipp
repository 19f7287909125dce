// The least squares of drift: new samples, the covariance of a calibration as a prior, and the
// parts that may have moved.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/drift.hpp"
#include "kinecal/trust/drift_rows.ipp"
#include "kinecal/trust/drift_whitening.ipp"
#include "kinecal/trust/joint_effects.ipp"

namespace kinecal::detail {

/// The fit of new samples near a calibration.
class DriftFit {
 public:
  DriftFit(const AnyProblem& problem, std::span<const Sample> samples, const CalibratedState& state)
      : problem_(problem),
        poses_(pose_groups(problem, samples)),
        state_(state),
        free_(free_of(problem, state)),
        scale_(scales()) {
    evaluator_ = problem.evaluator(free_, 1);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(free_.size(), free_.size());
    const std::vector<int> calibrated = columns(state.parameters);
    covariance(calibrated, calibrated) = state.covariance.matrix();
    prior_ = root_of(covariance);
    unknown_ = Eigen::MatrixXd::Zero(free_.size(), std::ssize(state.undetermined));
    for (std::size_t c = 0; c < state.undetermined.size(); ++c) {
      for (const auto& [p, factor] : state.undetermined[c]) {
        if (free_.column(p) >= 0) unknown_(free_.column(p), static_cast<Eigen::Index>(c)) = factor;
      }
    }
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(free_.size(), free_.size());
    start_ = linear_fit(*evaluator_, state.values, {identity, {}, {}, {}});
    effects_ = joint_effects(problem, state.values, samples, free_, start_);
    for (const RowBlock& block : start_.blocks) {
      const double by = 1.0 / scale_[static_cast<std::size_t>(block.term)];
      effects_.middleRows(block.first, block.size) *= by;
    }
    std::vector<int> components;
    for (int t = 0; t < problem.num_terms(); ++t) {
      components.push_back(problem.term(t).feature_size);
    }
    shifts_ = feature_shifts(start_, components);
    start_ = scaled(std::move(start_));
  }

  /// True if some residual depends on a parameter: the orientation of a point does not matter.
  [[nodiscard]] bool matters(int parameter) const {
    constexpr double kNothing = 1e-6;  // of the noise, for a change by one metre or radian
    return start_.jacobian.col(free_.column(parameter)).norm() > kNothing;
  }
  /// True if what some parameters do to all residuals, others do as well, and conversely.
  [[nodiscard]] bool same_effect(const std::vector<int>& some,
                                 const std::vector<int>& others) const {
    std::vector<int> both = some;
    both.insert(both.end(), others.begin(), others.end());
    const Eigen::Index rank = rank_of(both);
    return rank == rank_of(some) && rank == rank_of(others);
  }
  /// The columns of the directions: errors of the calibration, undetermined directions, movements.
  [[nodiscard]] Eigen::MatrixXd directions(const std::vector<int>& moved) const {
    Eigen::MatrixXd all =
        Eigen::MatrixXd::Zero(free_.size(), prior_.cols() + unknown_.cols() + std::ssize(moved));
    all.leftCols(prior_.cols()) = prior_;
    all.middleCols(prior_.cols(), unknown_.cols()) = unknown_;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      all(free_.column(moved[i]), prior_.cols() + unknown_.cols() + static_cast<Eigen::Index>(i)) =
          1.0;
    }
    return all;
  }
  /// The fall of X from a minimum if these parameters have moved as well, to first order.
  [[nodiscard]] DriftFall fall(const std::vector<int>& moved, const DriftMinimum& from) const {
    const Reduced system = reduced(from.rows, directions(moved), from.z);
    return {system.slope.dot(system.inverse * system.slope), system.rank - from.rank};
  }
  /// Columns of some parameters among the free ones.
  [[nodiscard]] std::vector<int> columns(const std::vector<int>& parameters) const {
    std::vector<int> all;
    for (const int p : parameters) all.push_back(free_.column(p));
    return all;
  }
  /// (free x free) J^T V^-1 J: V the variance of the residuals if nothing has moved.
  /// @param at  minimum with nothing moved
  [[nodiscard]] Eigen::MatrixXd information(const DriftMinimum& at) const {
    const LinearFit::RowMajor& j = at.rows.jacobian;
    const Eigen::MatrixXd known = j.transpose() * (j * directions({}));
    return j.transpose() * j - known * at.inverse * known.transpose();
  }
  /// True if the information on a change of the free parameters is more than rounding.
  [[nodiscard]] bool shows(double information, const Eigen::VectorXd& change) const {
    constexpr double kRounding = 1e-9;
    return information > kRounding * (start_.jacobian * change).squaredNorm();
  }
  /// Minimizes X by Gauss-Newton steps, from the calibration.
  [[nodiscard]] DriftMinimum minimize(const Eigen::MatrixXd& directions,
                                      const std::vector<bool>& used) const {
    const Whitening whitening(problem_, start_, poses_, state_.common, effects_, shifts_, used);
    DriftMinimum at{.z = Eigen::VectorXd::Zero(directions.cols()), .inverse = {}, .rows = start_};
    whitening.apply(at.rows);
    at.statistic = at.rows.residual.squaredNorm();
    at.size = whitening.size();
    at.freedom = noise_freedom(problem_, state_, start_, whitening.shared());
    constexpr int kSteps = 40;  // a remounted board is far away
    bool falls = true;
    for (int i = 0; i < kSteps && falls; ++i) falls = step(directions, whitening, at);
    return at;
  }

 private:
  [[nodiscard]] Eigen::Index rank_of(const std::vector<int>& parameters) const {
    const Eigen::MatrixXd j = start_.jacobian(Eigen::all, columns(parameters));
    return j.cols() - Spectrum(j.transpose() * j).null;
  }
  /// The calibrated parameters, and all others that affect these samples.
  [[nodiscard]] static FreeSet free_of(const AnyProblem& problem, const CalibratedState& state) {
    std::vector<int> all = state.parameters;
    for (const int p : problem.touched_parameters()) {
      if (std::find(all.begin(), all.end(), p) == all.end()) all.push_back(p);
    }
    return FreeSet(std::move(all), problem.table().size());
  }
  /// Noise of the weighted residuals of each error block, without what features of a pose share.
  [[nodiscard]] std::vector<double> scales() const {
    std::vector<double> all;
    for (int t = 0; t < problem_.num_terms(); ++t) {
      const bool used = problem_.samples_of(t) > 0;
      all.push_back(used ? noise_of(state_, problem_.term(t).name).own_or_all() *
                               problem_.term(t).weight
                         : 1.0);
    }
    return all;
  }
  /// Values of all parameters after a change of the free ones.
  [[nodiscard]] std::vector<double> values(const Eigen::VectorXd& change) const {
    std::vector<double> all = state_.values;
    for (int c = 0; c < free_.size(); ++c) {
      all[static_cast<std::size_t>(free_.parameters()[static_cast<std::size_t>(c)])] += change(c);
    }
    return all;
  }
  /// Rows in standard deviations of the features' own noise.
  [[nodiscard]] LinearFit scaled(LinearFit rows) const {
    for (const RowBlock& block : rows.blocks) {
      const double by = 1.0 / scale_[static_cast<std::size_t>(block.term)];
      rows.residual.segment(block.first, block.size) *= by;
      rows.jacobian.middleRows(block.first, block.size) *= by;
    }
    return rows;
  }
  /// The equations of X in some directions.
  struct Reduced {
    Eigen::MatrixXd inverse;
    Eigen::VectorXd slope;  ///< half the derivative of X
    Eigen::Index rank;      ///< of the directions that cost nothing
  };
  [[nodiscard]] Reduced reduced(const LinearFit& rows, const Eigen::MatrixXd& directions,
                                const Eigen::VectorXd& z) const {
    const Eigen::Index known = prior_.cols();
    const Eigen::MatrixXd j = rows.jacobian * directions;
    Eigen::MatrixXd matrix = j.transpose() * j;
    matrix.diagonal().head(known).array() += 1.0;
    Eigen::VectorXd slope = j.transpose() * rows.residual;
    slope.head(known) += z.head(known);
    const Spectrum spectrum(matrix);
    return {spectrum.pseudo_inverse(), slope, directions.cols() - spectrum.null - known};
  }
  /// @returns  false if X no longer falls
  [[nodiscard]] bool step(const Eigen::MatrixXd& directions, const Whitening& whitening,
                          DriftMinimum& at) const {
    const Eigen::Index known = prior_.cols();
    const Reduced system = reduced(at.rows, directions, at.z);
    at.rank = system.rank;
    at.inverse = system.inverse;
    Eigen::VectorXd change = -system.inverse * system.slope;
    constexpr int kHalvings = 10;
    for (int i = 0; i < kHalvings; ++i, change *= 0.5) {
      const Eigen::VectorXd z = at.z + change;
      try {
        LinearFit rows =
            scaled(linear_fit(*evaluator_, values(directions * z), start_.coordinates));
        whitening.apply(rows);
        const double statistic = rows.residual.squaredNorm() + z.head(known).squaredNorm();
        if (!(statistic <= at.statistic)) continue;
        constexpr double kSettled = 1e-6;
        const bool falls = at.statistic - statistic > kSettled * (1.0 + statistic);
        at.z = z;
        at.statistic = statistic;
        at.rows = std::move(rows);
        return falls;
      } catch (const std::domain_error&) {  // a point behind a camera
      }
    }
    return false;
  }

  const AnyProblem& problem_;
  PoseGroups poses_;
  const CalibratedState& state_;
  FreeSet free_;
  std::vector<double> scale_;
  std::unique_ptr<AnyEvaluator> evaluator_;
  Eigen::MatrixXd prior_;    ///< (free x directions) B
  Eigen::MatrixXd unknown_;  ///< (free x directions) undetermined
  Eigen::MatrixXd effects_;  ///< (rows x joints) of joints that stop elsewhere than they say
  Eigen::MatrixXd shifts_;   ///< (rows x components) of all features of a pose alike
  LinearFit start_;          ///< rows at the calibration
};

}  // namespace kinecal::detail
