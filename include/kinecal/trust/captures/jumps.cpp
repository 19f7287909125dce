// Definitions of jumps.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/captures/jumps.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/errors/magnetic_field.hpp"
#include "kinecal/solve/linear_fit.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Adds the jumps of one error block.
void add_jumps(const Term& term, int number, const LinearFit& fit,
               std::map<int, std::string>& jumps) {
  constexpr double kTimes = 10.0;
  std::vector<std::pair<double, int>> sizes;  // of residuals, and their samples
  for (const RowBlock& block : fit.blocks) {
    if (block.term != number || block.size == 0) continue;
    sizes.emplace_back(fit.residual.segment(block.first, block.size).norm(), block.sample);
  }
  if (sizes.empty()) return;
  std::sort(sizes.begin(), sizes.end());
  const double most = sizes[sizes.size() * 9 / 10].first;
  for (const auto& [size, sample] : sizes) {
    if (!(most > 0.0) || !(size > kTimes * most)) continue;
    constexpr double kMost = 1e4;  // beyond it the number says nothing
    const double times = std::min(kMost, size / most);
    jumps.emplace(sample, "error block '" + term.name + "': it jumps: it is " +
                              (times < kMost ? "" : "over ") + std::to_string(std::lround(times)) +
                              " times as far off as nine of ten samples where the fit begins");
  }
}

}  // namespace
}  // namespace detail

std::map<int, std::string> jumps_at_start(const Calibration& calibration) {
  constexpr std::size_t kOneOf = 50;
  std::map<int, std::string> jumps;
  if (calibration.steps.empty()) return jumps;
  const CalibrationStep& step = calibration.steps.back();
  const AnyProblem& problem = *step.problem;
  const auto is_looked_at = [&](int t) {
    const std::string& type = problem.term(t).options.type;
    return is_base_type(type) || type == MagneticField::kType;
  };
  std::vector<int> terms;
  for (int t = 0; t < problem.num_terms(); ++t) {
    if (is_looked_at(t)) terms.push_back(t);
  }
  if (terms.empty()) return jumps;
  const Eigen::VectorXd at = calibration.table.values();
  const ParameterValues values(
      std::span<const double>(at.data(), static_cast<std::size_t>(at.size())));
  try {
    const LinearFit fit = linear_rows(*problem.evaluator(step.free, 1), values,
                                      determined_coordinates(problem, step.free, values), false);
    for (const int t : terms) detail::add_jumps(problem.term(t), t, fit, jumps);
  } catch (const std::domain_error&) {
    return {};
  }
  const auto samples = static_cast<std::size_t>(problem.num_samples());
  if (jumps.size() > std::max<std::size_t>(1, samples / kOneOf)) jumps.clear();
  return jumps;
}

}  // namespace kinecal
