// Two halves of the poses, solved apart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/projection_derivatives.ipp"
#include "kinecal/trust/projection_map.hpp"

namespace kinecal::detail {

/// Two halves of the poses.
struct Halves {
  std::array<Eigen::VectorXd, 2>
      values;  ///< of all parameters of the table, each half solved apart
  Eigen::MatrixXd
      spread;  ///< (free x free) covariance of their difference over unit noise: (H_1^-1 + H_2^-1)
  Eigen::MatrixXd whole;  ///< (free x free) the same of all poses: H^-1

  /// Covariance of the difference of some free parameters.
  /// @param known  their covariance with all poses, which has the noise and what poses share
  [[nodiscard]] Eigen::MatrixXd covariance(const std::vector<int>& columns,
                                           const Eigen::MatrixXd& known) const {
    const Eigen::MatrixXd unit = whole(columns, columns);
    return known.diagonal().cwiseQuotient(unit.diagonal()).mean() * spread(columns, columns);
  }
};

/// Solves each half of the poses apart; nullopt if that fails.
[[nodiscard]] inline std::optional<Halves> halves_of(const KnownSolution& solution) {
  constexpr int kFewest = 8;
  if (solution.poses.count < kFewest) return std::nullopt;
  const LinearFit& fit = solution.fit;
  const Eigen::MatrixXd& basis = fit.coordinates.basis;
  const auto inverse = [&](const Eigen::VectorXd& weights, double priors) {
    return Eigen::MatrixXd(basis * Spectrum(information(fit, weights, priors)).pseudo_inverse() *
                           basis.transpose());
  };
  Halves halves{{}, Eigen::MatrixXd::Zero(basis.rows(), basis.rows()), inverse(fit.loss, 1.0)};
  for (int half = 0; half < 2; ++half) {
    Eigen::VectorXd weights = fit.loss;
    for (const RowBlock& block : fit.blocks) {
      const int pose = solution.poses.of_sample[static_cast<std::size_t>(block.sample)];
      if (pose % 2 == half) weights.segment(block.first, block.size).setZero();
    }
    halves.spread += inverse(weights, 0.5);
    try {
      halves.values[static_cast<std::size_t>(half)] =
          refit(solution.evaluator, solution.values, fit, weights, 0.5).values;
    } catch (const std::domain_error&) {  // a point behind a camera
      return std::nullopt;
    }
  }
  return halves;
}

/// How far halves are apart where features are, beside what is expected; nullopt if nothing is.
/// @param derivatives  A of projection_map.hpp, of each cell
/// @param covariance   of the difference of the camera's free parameters
/// @param freedom      of the noise
[[nodiscard]] inline std::optional<HalvesApart> halves_apart(
    const ProjectionMap& map, const std::vector<SolvedProjection::PixelByFree>& derivatives,
    const Eigen::MatrixXd& covariance, double freedom) {
  const Eigen::Index n = covariance.rows();
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, n);
  double difference = 0.0, cells = 0.0;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i].features == 0 || !derivatives[i].allFinite()) continue;
    squares += derivatives[i].transpose() * derivatives[i];
    difference += map.cells[i].difference * map.cells[i].difference;
    cells += 1.0;
  }
  if (cells == 0.0) return std::nullopt;
  const Eigen::MatrixXd of_pixels = covariance * squares;
  const double allowed = of_pixels.trace();
  if (!(allowed > 0.0)) return std::nullopt;
  const double independent = allowed * allowed / (of_pixels * of_pixels).trace();
  return HalvesApart{std::sqrt(difference / cells), std::sqrt(allowed / cells),
                     f_tail(difference / allowed, independent, freedom)};
}

}  // namespace kinecal::detail
