// Rows of a calibration, what a lag changes in them, and the noise apart from that.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/stamp_jitter.ipp"

namespace kinecal::detail {

/// Rows of a calibration at its solution, and their derivatives by the stamp: a wrong stamp is a change
/// of all lags, since camera and target are both where they were at another time.
struct LagRows {
  LinearFit fit;            ///< by the free parameters
  Eigen::MatrixXd inverse;  ///< (coordinates x coordinates) of J^T J
  Eigen::VectorXd slope;    ///< (rows) by the stamp, 1/s
  Eigen::VectorXd sigma;    ///< (rows) noise of the weighted residual
};

/// Derivatives of all rows by one parameter.
[[nodiscard]] inline Eigen::VectorXd column_of(const AnyProblem& problem, int parameter,
                                               ParameterValues values) {
  const FreeSet only({parameter}, problem.table().size());
  const Coordinates itself{Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd(1, 0),
                           Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)};
  return linear_fit(*problem.evaluator(only, 1), values, itself).jacobian.col(0);
}

/// Noise of each error block, across the direction in which a wrong stamp moves the rows of a sample:
/// robustly, from the median of samples.
[[nodiscard]] inline Eigen::VectorXd noise_across(const LagRows& rows) {
  std::map<int, std::vector<double>> variances;  // by error block
  for (const RowBlock& block : rows.fit.blocks) {
    const auto r = rows.fit.residual.segment(block.first, block.size);
    const auto c = rows.slope.segment(block.first, block.size);
    const double along = c.squaredNorm() > 0.0 ? r.dot(c) * r.dot(c) / c.squaredNorm() : 0.0;
    const double freedom = static_cast<double>(block.size - (c.squaredNorm() > 0.0 ? 1 : 0));
    if (freedom < 1.0) continue;
    const double median =
        std::pow(1.0 - 2.0 / (9.0 * freedom), 3);  // of chi-square (Wilson, Hilferty)
    variances[block.term].push_back((r.squaredNorm() - along) / (freedom * median));
  }
  const auto all = static_cast<double>(rows.fit.residual.size());
  const double kept = std::max(0.1, 1.0 - static_cast<double>(rows.fit.size()) / all);
  Eigen::VectorXd sigma = Eigen::VectorXd::Ones(rows.fit.residual.size());
  for (const RowBlock& block : rows.fit.blocks) {
    const auto found = variances.find(block.term);
    if (found == variances.end()) continue;
    const double variance = median_of(found->second) / kept;
    if (variance > 0.0) sigma.segment(block.first, block.size).setConstant(std::sqrt(variance));
  }
  return sigma;
}

/// @param lags  indices in the table
[[nodiscard]] inline LagRows lag_rows(const AnyProblem& problem, const FreeSet& free,
                                      ParameterValues values, const std::vector<int>& lags) {
  LagRows rows;
  const Coordinates determined = determined_coordinates(problem, free, values);
  rows.fit = linear_fit(*problem.evaluator(free, 1), values, determined);
  rows.slope = Eigen::VectorXd::Zero(rows.fit.residual.size());
  for (const int lag : lags) rows.slope += column_of(problem, lag, values);
  rows.sigma = noise_across(rows);
  const Eigen::MatrixXd hessian =
      rows.fit.jacobian.transpose() * rows.fit.jacobian + rows.fit.prior_hessian;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(rows.fit.size(), rows.fit.size());
  rows.inverse = Ldlt(hessian).solve(identity);
  return rows;
}

}  // namespace kinecal::detail
