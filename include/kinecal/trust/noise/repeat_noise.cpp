// Testing for lack of fit.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/repeat_noise.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/noise/pose_rows.ipp"

namespace kinecal {

void set_repeats(const LinearFit& fit, const PoseGroups& poses, std::vector<BlockNoise>& noise) {
  std::vector<double> squares(noise.size(), 0.0);
  for (const auto& pose : detail::blocks_by_pose(fit, poses)) {
    // Readings with as many rows compare the same features.
    std::map<std::pair<int, Eigen::Index>, std::vector<std::size_t>> readings;
    for (const std::size_t b : pose)
      readings[{fit.blocks[b].term, fit.blocks[b].size}].push_back(b);
    for (const auto& [of, blocks] : readings) {
      const auto t = static_cast<std::size_t>(of.first);
      const auto count = static_cast<double>(blocks.size());
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(of.second);
      const auto reading = [&](std::size_t b) {
        return fit.residual.segment(fit.blocks[b].first, fit.blocks[b].size);
      };
      for (const std::size_t b : blocks) mean += reading(b) / count;
      for (const std::size_t b : blocks) squares[t] += (reading(b) - mean).squaredNorm();
      noise[t].repeats_freedom += (count - 1.0) * static_cast<double>(of.second);
    }
  }
  constexpr double kFew = 10.0;
  for (std::size_t t = 0; t < noise.size(); ++t) {
    if (noise[t].repeats_freedom < kFew) continue;
    noise[t].repeats = noise[t].unit_sigma * std::sqrt(squares[t] / noise[t].repeats_freedom);
  }
}

bool lacks_fit(const BlockNoise& noise) {
  constexpr double kTimes = 3.0, kChance = 1e-6;
  const double left = noise.freedom - noise.repeats_freedom;
  if (!(noise.repeats > 0.0) || !(left > 0.0) || noise.sigma < kTimes * noise.repeats) return false;
  const double squares = noise.sigma * noise.sigma, pure = noise.repeats * noise.repeats;
  const double lack = (squares * noise.freedom - pure * noise.repeats_freedom) / left;
  return f_tail(lack / pure, left, noise.repeats_freedom) < kChance;
}

}  // namespace kinecal
