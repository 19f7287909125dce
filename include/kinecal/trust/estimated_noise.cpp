// Estimating sigmas.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/estimated_noise.hpp"

#include <cmath>

namespace kinecal {

EstimatedNoise::EstimatedNoise(const Calibration& calibration) {
  for (std::size_t s = 0; s < calibration.steps.size(); ++s) {
    const AnyProblem& problem = *calibration.steps[s].problem;
    std::vector<Estimated> without;
    for (int t = 0; t < problem.num_terms(); ++t) {
      if (!problem.term(t).options.sigma) without.push_back({s, t});
    }
    for (const Estimated& block : without) {
      const bool has_loss = problem.term(block.term).options.loss.type != LossType::none;
      if (without.size() > 1 || has_loss) blocks_.push_back(block);
    }
  }
}

bool EstimatedNoise::update(Calibration& calibration, const OfSteps& noise) const {
  std::vector<std::pair<Estimated, double>> found;
  bool changed = false;
  for (const Estimated& block : blocks_) {
    const Term& term = calibration.steps[block.step].problem->term(block.term);
    const BlockNoise* of = nullptr;
    for (const std::vector<BlockNoise>& step : noise) {
      for (const BlockNoise& one : step) of = one.block == term.name ? &one : of;
    }
    if (of == nullptr || !(of->robust > 0.0)) continue;
    constexpr double kStays = 0.01;
    const double before = term.sigma;
    changed = changed || std::abs(of->robust - before) > kStays * before;
    found.emplace_back(block, of->robust);
  }
  if (!changed) return false;
  for (const auto& [block, sigma] : found) {
    calibration.steps[block.step].set_sigma(block.term, sigma);
  }
  return true;
}

void EstimatedNoise::reset(Calibration& calibration) const {
  for (const Estimated& block : blocks_) {
    calibration.steps[block.step].set_sigma(block.term, 1.0);
  }
}

std::vector<double> EstimatedNoise::sigmas(const Calibration& calibration) const {
  std::vector<double> all;
  for (const Estimated& block : blocks_) {
    all.push_back(calibration.steps[block.step].problem->term(block.term).sigma);
  }
  return all;
}

}  // namespace kinecal
