// Singular values of a Jacobian.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"

namespace kinecal::detail {

KINECAL_INLINE std::vector<int> nonzero_columns(const Eigen::MatrixXd& rows) {
  std::vector<int> columns;
  for (int c = 0; c < rows.cols(); ++c) {
    if (!rows.col(c).isZero(0.0)) columns.push_back(c);
  }
  return columns;
}

KINECAL_INLINE Eigen::MatrixXd error_free_information(const AnyProblem& problem,
                                                      const FreeSet& free, ParameterValues values) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(free.size(), free.size());
  const auto add = [&](int t, int, const TermResiduals& out) {
    const Eigen::VectorXd weights = problem.term(t).weight * out.factor;
    const std::vector<int> columns = nonzero_columns(out.jacobian);
    const Eigen::MatrixXd weighted = weights.asDiagonal() * out.jacobian(Eigen::all, columns);
    const Eigen::MatrixXd squared = weighted.transpose() * weighted;
    sum(columns, columns) += squared;
  };
  (void)evaluate(problem, values, &free, add, Linearization::error_free);
  return sum;
}

KINECAL_INLINE Spectrum::Spectrum(const Eigen::MatrixXd& information)
    : scale(
          information.diagonal().unaryExpr([](double d) { return d > 0.0 ? std::sqrt(d) : 1.0; })) {
  if (information.size() == 0) return;  // Eigen's solver takes no empty matrix
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * information * scale.cwiseInverse().asDiagonal();
  Eigenpairs pairs = eigenpairs(scaled);
  singular = pairs.values.cwiseMax(0.0).cwiseSqrt();
  vectors = std::move(pairs.vectors);
  // all of them where the Jacobian is zero
  null = (singular.array() <= kUnobservable * singular.maxCoeff()).count();
}

KINECAL_INLINE Eigen::MatrixXd Spectrum::pseudo_inverse() const {
  const Eigen::Index rank = singular.size() - null;
  const Eigen::MatrixXd half = scale.cwiseInverse().asDiagonal() * vectors.rightCols(rank) *
                               singular.tail(rank).cwiseInverse().asDiagonal();
  return half * half.transpose();
}

}  // namespace kinecal::detail
