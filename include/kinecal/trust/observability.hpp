// What the samples cannot tell: combinations of parameters that change no residual.
//
// Decided on the error-free problem (measurements replaced by the model's prediction), priors left
// out.  J is its weighted Jacobian with columns scaled to length one; a singular value of J below
// kUnobservable means that the combination of parameters belonging to it has no effect.  A basis of
// these combinations is reduced until each has a parameter of its own with factor one.
// Source: Hollerbach, Wampler, The Calibration Index and Taxonomy for Robot Kinematic Calibration
// Methods, 1996; the error-free problem: the design of kinecal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Eigenvalues>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/crate/evaluate.hpp"

namespace kinecal {

/// A combination of parameters: table index and factor, the largest effect first.
using Combination = std::vector<std::pair<int, double>>;

struct Observability {
  int rank = 0;
  double condition = 1.0;  ///< largest over least singular value of what can be observed
  std::vector<Combination> unobservable;
};

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

/// What the samples of a problem tell about its free parameters, near the given values.
template <class S>
[[nodiscard]] Observability observability(const BasicProblem<S>& problem, const FreeSet& free,
                                          std::span<const double> values) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(free.size(), free.size());
  const auto add = [&](int t, int, const TermResiduals& out) {
    const double weight = problem.terms()[static_cast<std::size_t>(t)]->options().weight;
    normal.noalias() += weight * weight * out.jacobian.transpose() * out.jacobian;
  };
  (void)evaluate(problem, values, &free, add, Linearization::error_free);
  const Eigen::VectorXd scale =
      normal.diagonal().unaryExpr([](double d) { return d > 0.0 ? std::sqrt(d) : 1.0; });
  normal = scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(normal);
  const Eigen::VectorXd singular = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();

  Observability result;
  const Eigen::Index null =
      (singular.array() < detail::kUnobservable * singular.maxCoeff()).count();
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
