// Finding what cannot be observed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kinecal/evaluation/evaluate.hpp"
#include "kinecal/trust/observability.hpp"

namespace kinecal {

namespace detail {

/// Singular values of 1e-8 and below are rounding: they are roots of eigenvalues of J^T J.
inline constexpr double kUnobservable = 1e-6;

/// Reduces the columns of a basis (Gauss-Jordan with full pivoting) until each has a row in which
/// it is one and the others are zero.
inline void reduce(Eigen::MatrixXd& basis) {
  std::vector<bool> used(static_cast<std::size_t>(basis.rows()), false);
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    Eigen::Index pivot = 0, column = c;
    double largest = -1.0;
    for (Eigen::Index j = c; j < basis.cols(); ++j) {
      for (Eigen::Index i = 0; i < basis.rows(); ++i) {
        if (used[static_cast<std::size_t>(i)] || std::abs(basis(i, j)) <= largest) continue;
        largest = std::abs(basis(i, j));
        pivot = i;
        column = j;
      }
    }
    basis.col(c).swap(basis.col(column));
    used[static_cast<std::size_t>(pivot)] = true;
    basis.col(c) /= basis(pivot, c);
    for (Eigen::Index j = 0; j < basis.cols(); ++j) {
      if (j != c) basis.col(j) -= basis(pivot, j) * basis.col(c);
    }
  }
}

/// The parameters of one column whose effect is not negligible, in the parameters' own units.
/// @param scale  length of each parameter's column of the Jacobian
[[nodiscard]] inline Combination combination(const Eigen::VectorXd& scaled,
                                             const Eigen::VectorXd& scale, const FreeSet& free) {
  constexpr double kNegligible = 1e-3;  // of the largest effect
  std::vector<std::pair<double, Eigen::Index>> order;
  for (Eigen::Index i = 0; i < scaled.size(); ++i) {
    const double effect = std::abs(scaled(i));
    if (effect > kNegligible * scaled.cwiseAbs().maxCoeff()) order.emplace_back(-effect, i);
  }
  std::sort(order.begin(), order.end());
  Combination result;
  const Eigen::Index first = order.front().second;
  const double unit = scaled(first) / scale(first);
  for (const auto& [effect, i] : order) {
    result.emplace_back(free.parameters()[static_cast<std::size_t>(i)],
                        scaled(i) / scale(i) / unit);
  }
  return result;
}

}  // namespace detail

KINECAL_INLINE Observability observability(const AnyProblem& problem, const FreeSet& free,
                                           std::span<const double> values) {
  if (free.size() == 0) return {};
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(free.size(), free.size());
  const auto add = [&](int t, int, const TermResiduals& out) {
    const Eigen::VectorXd weights = problem.term(t).options().weight * out.factor;
    const Eigen::MatrixXd weighted = weights.asDiagonal() * out.jacobian;
    normal.noalias() += weighted.transpose() * weighted;
  };
  (void)evaluate(problem, values, &free, add, Linearization::error_free);
  const Eigen::VectorXd scale =
      normal.diagonal().unaryExpr([](double d) { return d > 0.0 ? std::sqrt(d) : 1.0; });
  normal = scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(normal);
  const Eigen::VectorXd singular = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();

  Observability result;
  const Eigen::Index null =  // all of them where the Jacobian is zero
      (singular.array() <= detail::kUnobservable * singular.maxCoeff()).count();
  result.rank = free.size() - static_cast<int>(null);
  if (result.rank > 0) result.condition = singular.maxCoeff() / singular(null);
  Eigen::MatrixXd basis = eigen.eigenvectors().leftCols(null);
  detail::reduce(basis);
  for (Eigen::Index c = 0; c < null; ++c) {
    result.unobservable.push_back(detail::combination(basis.col(c), scale, free));
  }
  return result;
}

}  // namespace kinecal
