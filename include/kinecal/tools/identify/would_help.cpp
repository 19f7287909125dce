// Definitions of would_help.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/would_help.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/tools/identify/identified_config.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Table indices, in another table, of the parameters that a step frees.
[[nodiscard]] std::vector<int> free_in(const ParameterTable& table,
                                       const Calibration& calibration) {
  std::vector<int> all;
  for (const int p : calibration.steps.front().free.parameters()) {
    const int index = table.find(calibration.table[p].name);
    if (index >= 0) all.push_back(index);
  }
  return all;
}

}  // namespace
}  // namespace detail

std::vector<std::string> would_help(const Config& config, const Robot& robot,
                                    std::span<const Sample> samples, const Calibration& calibration,
                                    const CalibrationResult& result) {
  constexpr std::size_t kFewest = 10, kMost = 20000;  // samples
  const bool fits = result.converged && config.steps.size() == 1 && calibration.steps.size() == 1;
  if (!fits || samples.size() < kFewest || samples.size() > kMost) return {};
  Diagnostics ignored;
  Calibration wide = assemble(with_all_candidates(config, robot), robot, samples, ignored);
  if (!ignored.errors.empty() || wide.steps.size() != 1) return {};
  for (const Parameter& p : result.table) {
    const int index = wide.table.find(p.name);
    if (index >= 0) wide.table[index].value = p.value;
  }
  wide.steps.front().unknown_frames.clear();  // they are known by now
  wide.steps.front().assignments.clear();
  const std::vector<int> base = detail::free_in(wide.table, calibration);
  std::vector<IdentifyCandidate> candidates =
      identify_task(config, *wide.steps.front().problem).candidates;
  std::erase_if(candidates, [&](const IdentifyCandidate& candidate) {
    return std::any_of(candidate.parameters.begin(), candidate.parameters.end(),
                       [&](int p) { return std::find(base.begin(), base.end(), p) != base.end(); });
  });
  std::vector<std::string> sentences;
  const std::vector<IdentifyStep> steps = most_helpful(wide, samples, base, candidates);
  const std::string unit = wide.steps.front().problem->term(0).options.unit;
  constexpr double kMuch = 0.9;
  for (std::size_t i = 1; i < steps.size() && steps[i].held_out < kMuch * steps[i - 1].held_out;
       ++i) {
    sentences.push_back(
        (i == 1 ? "freeing " : "and with it ") +
        candidates[static_cast<std::size_t>(steps[i].candidate)].name +
        (i == 1 ? " lowers the error on held-out poses from " + reading(steps[0].held_out, unit)
                : "") +
        " to " + reading(steps[i].held_out, unit));
  }
  return sentences;
}

}  // namespace kinecal
