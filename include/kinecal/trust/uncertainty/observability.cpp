// Finds unobservable parameter combinations.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/observability.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/trust/uncertainty/reluctance.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Reduces the columns of a basis (Gauss-Jordan with full pivoting) until each has a row in which
/// it is one and the others are zero.
void reduce(Eigen::MatrixXd& basis) {
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

/// The parameters of one column with a significant effect, in the parameters' own units.
/// @param scale  length of each parameter's column of the Jacobian
[[nodiscard]] Combination combination(const Eigen::VectorXd& scaled, const Eigen::VectorXd& scale,
                                      const FreeSet& free) {
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

/// Parameters to hold so that the null space vanishes.
/// @param null  (free x directions), orthonormal
[[nodiscard]] std::vector<int> parameters_to_hold(const AnyProblem& problem, const FreeSet& free,
                                                  Eigen::MatrixXd null) {
  std::vector<int> order(static_cast<std::size_t>(free.size()));
  for (int c = 0; c < free.size(); ++c) order[static_cast<std::size_t>(c)] = free.size() - 1 - c;
  const auto parameter = [&](int c) { return free.parameters()[static_cast<std::size_t>(c)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return reluctance(problem, parameter(a)) < reluctance(problem, parameter(b));
  });
  std::vector<int> held;
  for (double least = 0.3; null.cols() > 0 && least > kUnobservable; least *= 0.1) {
    for (const int c : order) {
      if (null.cols() == 0 || null.row(c).norm() < least) continue;
      held.push_back(parameter(c));
      // The rest has no part of this parameter: reflect its row onto the first direction.
      Eigen::VectorXd normal = null.row(c).transpose();
      normal(0) += std::copysign(normal.norm(), normal(0));
      const Eigen::VectorXd twice = null * normal * (2.0 / normal.squaredNorm());
      null = (null - twice * normal.transpose()).rightCols(null.cols() - 1).eval();
    }
  }
  return held;
}

}  // namespace
}  // namespace detail

Observability detail::observability_of(const AnyProblem& problem, const FreeSet& free,
                                       const SampleInformation& samples) {
  const Spectrum spectrum = determined_spectrum(samples, Priors::ignored);
  const Eigen::VectorXd& singular = spectrum.singular;
  Observability result;
  result.rank = free.size() - static_cast<int>(spectrum.null);
  if (result.rank > 0) result.condition = singular.maxCoeff() / singular(spectrum.null);
  Eigen::MatrixXd basis = spectrum.vectors.leftCols(spectrum.null);
  result.hold = detail::parameters_to_hold(problem, free, basis);
  detail::reduce(basis);
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    result.unobservable.push_back(detail::combination(basis.col(c), spectrum.scale, free));
  }
  return result;
}

Observability observability(const AnyProblem& problem, const FreeSet& free,
                            ParameterValues values) {
  if (free.size() == 0) return {};
  return detail::observability_of(problem, free, detail::sample_information(problem, free, values));
}

}  // namespace kinecal
