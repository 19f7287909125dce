// Finds ruined captures.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/captures/ruined.hpp"

#include <cmath>

namespace kinecal {

double noise_without_bad(const LinearFit& fit, const std::vector<CaptureError>& captures) {
  Eigen::VectorXd weights = fit.loss;
  double rows = 0.0;
  for (const RowBlock& block : fit.blocks) {
    if (captures[static_cast<std::size_t>(block.sample)].bad) {
      weights.segment(block.first, block.size).setZero();
    } else {
      rows += static_cast<double>(block.size);
    }
  }
  const auto size = static_cast<double>(fit.residual.size()), n = static_cast<double>(fit.size());
  if (rows == size || !(rows > n)) return 1.0;
  const Eigen::VectorXd without = fit.residual + fit.jacobian * step_to_minimum(fit, weights);
  const double all = fit.loss.dot(fit.residual.cwiseAbs2()) / (size - n);
  return all > 0.0 ? std::sqrt(weights.dot(without.cwiseAbs2()) / (rows - n) / all) : 1.0;
}

bool explains_more(const Assessment& last) {
  return last.systematic && last.systematic->noise_left <= last.noise_without_bad;
}

std::vector<CaptureError> ruined_captures(const Assessment& last) {
  std::vector<CaptureError> ruined;
  if (explains_more(last)) return ruined;
  for (const CaptureError& error : last.captures) {
    if (error.bad) ruined.push_back(error);
  }
  constexpr double kMost = 0.25;
  const double most = kMost * static_cast<double>(last.captures.size());
  if (static_cast<double>(ruined.size()) > most) ruined.clear();
  return ruined;
}

}  // namespace kinecal
