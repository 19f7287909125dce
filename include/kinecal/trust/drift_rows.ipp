// New samples as rows, and the covariance of a calibration as columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/drift.hpp"

namespace kinecal::detail {

/// B with C = B B^T.
[[nodiscard]] inline Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigenpairs pairs = eigenpairs(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  constexpr double kRounding = 1e-14;
  const Eigen::VectorXd roots = pairs.values.unaryExpr(
      [](double lambda) { return lambda > kRounding ? std::sqrt(lambda) : 0.0; });
  const auto zeros = std::count(roots.begin(), roots.end(), 0.0);
  return scale.asDiagonal() * (pairs.vectors * roots.asDiagonal()).rightCols(roots.size() - zeros);
}

/// The noise of an error block.
/// @throws std::invalid_argument  if it is unknown
[[nodiscard]] inline const BlockNoise& noise_of(const CalibratedState& state,
                                                const std::string& block) {
  for (const BlockNoise& noise : state.noise) {
    if (noise.block == block && noise.sigma > 0.0) return noise;
  }
  throw std::invalid_argument("the noise of error block '" + block + "' is not known");
}

/// Degrees of freedom of the noise, by the shares of error blocks and shared noise in the rows (Welch).
/// @param shared  rows of shared noise
[[nodiscard]] inline double noise_freedom(const AnyProblem& problem, const CalibratedState& state,
                                          const LinearFit& rows, double shared) {
  const auto all = static_cast<double>(rows.residual.size());
  std::vector<double> own(static_cast<std::size_t>(problem.num_terms()), 0.0);
  for (const RowBlock& block : rows.blocks) {
    own[static_cast<std::size_t>(block.term)] +=
        (1.0 - shared / all) * static_cast<double>(block.size);
  }
  double sum = shared > 0.0 ? shared * shared / std::max(1.0, state.common.freedom) : 0.0;
  for (std::size_t t = 0; t < own.size(); ++t) {
    if (own[t] == 0.0) continue;
    const BlockNoise& noise = noise_of(state, problem.term(static_cast<int>(t)).name);
    sum += own[t] * own[t] / std::max(1.0, noise.own_freedom_or_all());
  }
  return sum > 0.0 ? all * all / sum : 1.0;
}

/// The fall of X when something is freed.
struct DriftFall {
  double fall = 0.0;
  Eigen::Index rank = 0;  ///< of the freed parameters
};

/// A minimum of X.
struct DriftMinimum {
  Eigen::VectorXd z;        ///< (directions) where it is
  double statistic = 0.0;   ///< X
  Eigen::Index rank = 0;    ///< of the directions that cost nothing
  Eigen::MatrixXd inverse;  ///< (directions x directions) covariance of z
  LinearFit rows;           ///< there, whitened; derivatives by the free parameters themselves
  double size = 0.0;        ///< number of independent rows
  double freedom = 0.0;     ///< of the noise
};

}  // namespace kinecal::detail
