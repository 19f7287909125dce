// The least squares of drift: new samples, the covariance of a calibration as a prior, and the
// parts that may have moved.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/drift.hpp"
#include "kinecal/trust/drift_rows.ipp"

namespace kinecal::detail {

/// The fit of new samples near a calibration.
class DriftFit {
 public:
  DriftFit(const AnyProblem& problem, const CalibratedState& state)
      : problem_(problem), state_(state), free_(free_of(problem, state)), scale_(scales()) {
    evaluator_ = problem.evaluator(free_, 1);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(free_.size(), free_.size());
    std::vector<int> columns;
    for (const int p : state.parameters) columns.push_back(free_.column(p));
    covariance(columns, columns) = state.covariance.matrix();
    prior_ = root_of(covariance);
    unknown_ = Eigen::MatrixXd::Zero(free_.size(), std::ssize(state.undetermined));
    for (std::size_t c = 0; c < state.undetermined.size(); ++c) {
      for (const auto& [p, factor] : state.undetermined[c]) {
        if (free_.column(p) >= 0) unknown_(free_.column(p), static_cast<Eigen::Index>(c)) = factor;
      }
    }
    start_ = rows_at(state.values);
  }

  /// Number of residuals of the used samples.
  [[nodiscard]] double size(const std::vector<bool>& used) const {
    double rows = 0.0;
    for (const RowBlock& block : start_.fit.blocks) {
      if (used[static_cast<std::size_t>(block.sample)]) rows += static_cast<double>(block.size);
    }
    return rows;
  }
  /// True if some residual depends on a parameter: the orientation of a point does not matter.
  [[nodiscard]] bool matters(int parameter) const {
    constexpr double kNothing = 1e-6;  // of the noise, for a change by one metre or radian
    return start_.fit.jacobian.col(free_.column(parameter)).norm() > kNothing;
  }
  /// Degrees of freedom of the noise, by the error blocks' shares of the residuals (Welch).
  [[nodiscard]] double noise_freedom() const {
    std::vector<double> rows(state_.noise.size(), 0.0);
    for (const RowBlock& block : start_.fit.blocks) {
      rows[noise_of(block.term)] += static_cast<double>(block.size);
    }
    double sum = 0.0, shares = 0.0;
    for (std::size_t b = 0; b < rows.size(); ++b) {
      sum += rows[b];
      if (rows[b] > 0.0) shares += rows[b] * rows[b] / std::max(1.0, state_.noise[b].freedom);
    }
    return shares > 0.0 ? sum * sum / shares : 1.0;
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
  /// J^T J and J^T r of the rows at a minimum.
  [[nodiscard]] DriftSums sums(const NewRows& rows, const std::vector<bool>& used) const {
    DriftSums all{Eigen::MatrixXd::Zero(free_.size(), free_.size()),
                  Eigen::VectorXd::Zero(free_.size())};
    for (const RowBlock& block : rows.fit.blocks) {
      if (!used[static_cast<std::size_t>(block.sample)]) continue;
      const auto j = rows.fit.jacobian.middleRows(block.first, block.size);
      all.matrix.noalias() += j.transpose() * j;
      all.gradient.noalias() += j.transpose() * rows.fit.residual.segment(block.first, block.size);
    }
    return all;
  }
  /// The fall of X from a minimum if these parameters have moved as well, to first order.
  [[nodiscard]] DriftFall fall(const DriftSums& sums, const std::vector<int>& moved,
                               const DriftMinimum& from) const {
    const Reduced system = reduced(sums, directions(moved), from.z);
    return {system.slope.dot(system.inverse * system.slope), system.rank - from.rank};
  }
  /// Minimizes X by Gauss-Newton steps, from the calibration.
  [[nodiscard]] DriftMinimum minimize(const Eigen::MatrixXd& directions,
                                      const std::vector<bool>& used) const {
    DriftMinimum at{.z = Eigen::VectorXd::Zero(directions.cols()), .inverse = {}, .rows = start_};
    at.statistic = start_.cost(used);
    constexpr int kSteps = 40;  // a remounted board is far away
    bool falls = true;
    for (int i = 0; i < kSteps && falls; ++i) falls = step(directions, used, at);
    return at;
  }

 private:
  /// The calibrated parameters, and all others that affect these samples.
  [[nodiscard]] static FreeSet free_of(const AnyProblem& problem, const CalibratedState& state) {
    std::vector<int> all = state.parameters;
    for (const int p : problem.touched_parameters()) {
      if (std::find(all.begin(), all.end(), p) == all.end()) all.push_back(p);
    }
    return FreeSet(std::move(all), problem.table().size());
  }
  [[nodiscard]] std::size_t noise_of(int term) const {
    const std::string& name = problem_.term(term).name;
    for (std::size_t b = 0; b < state_.noise.size(); ++b) {
      if (state_.noise[b].block == name && state_.noise[b].sigma > 0.0) return b;
    }
    throw std::invalid_argument("the noise of error block '" + name + "' is not known");
  }
  /// Noise of the weighted residuals of each error block.
  [[nodiscard]] std::vector<double> scales() const {
    std::vector<double> all;
    for (int t = 0; t < problem_.num_terms(); ++t) {
      const bool used = problem_.samples_of(t) > 0;
      all.push_back(used ? state_.noise[noise_of(t)].sigma * problem_.term(t).weight : 1.0);
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
  [[nodiscard]] NewRows rows_at(const std::vector<double>& values) const {
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(free_.size(), free_.size());
    NewRows rows{linear_fit(*evaluator_, values, {identity, {}, {}, {}})};
    for (const RowBlock& block : rows.fit.blocks) {
      const double by = 1.0 / scale_[static_cast<std::size_t>(block.term)];
      rows.fit.residual.segment(block.first, block.size) *= by;
      rows.fit.jacobian.middleRows(block.first, block.size) *= by;
    }
    return rows;
  }
  /// The equations of X in some directions.
  struct Reduced {
    Eigen::MatrixXd inverse;
    Eigen::VectorXd slope;  ///< half the derivative of X
    Eigen::Index rank;      ///< of the directions that cost nothing
  };
  [[nodiscard]] Reduced reduced(const DriftSums& sums, const Eigen::MatrixXd& directions,
                                const Eigen::VectorXd& z) const {
    const Eigen::Index known = prior_.cols();
    Eigen::MatrixXd matrix = directions.transpose() * sums.matrix * directions;
    matrix.diagonal().head(known).array() += 1.0;
    Eigen::VectorXd slope = directions.transpose() * sums.gradient;
    slope.head(known) += z.head(known);
    const Spectrum spectrum(matrix);
    return {spectrum.pseudo_inverse(), slope, directions.cols() - spectrum.null - known};
  }
  /// @returns  false if X no longer falls
  [[nodiscard]] bool step(const Eigen::MatrixXd& directions, const std::vector<bool>& used,
                          DriftMinimum& at) const {
    const Eigen::Index known = prior_.cols();
    const Reduced system = reduced(sums(at.rows, used), directions, at.z);
    at.rank = system.rank;
    at.inverse = system.inverse;
    Eigen::VectorXd change = -system.inverse * system.slope;
    constexpr int kHalvings = 10;
    for (int i = 0; i < kHalvings; ++i, change *= 0.5) {
      const Eigen::VectorXd z = at.z + change;
      try {
        NewRows rows = rows_at(values(directions * z));
        const double statistic = rows.cost(used) + z.head(known).squaredNorm();
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
  const CalibratedState& state_;
  FreeSet free_;
  std::vector<double> scale_;
  std::unique_ptr<AnyEvaluator> evaluator_;
  Eigen::MatrixXd prior_;    ///< (free x directions) B
  Eigen::MatrixXd unknown_;  ///< (free x directions) undetermined
  NewRows start_;
};

}  // namespace kinecal::detail
