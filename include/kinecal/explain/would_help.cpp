// Definitions of would_help.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/explain/would_help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/some_samples.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/tools/identify/identified_config.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"
#include "kinecal/trust/plausible_change.hpp"

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

/// The camera of pixels that owns all of these parameters; empty if absent.
[[nodiscard]] std::string owning_camera(const AnyProblem& problem,
                                        const std::vector<int>& parameters) {
  for (const MountedSensor& sensor : problem.sensors()) {
    const std::vector<int>& own = sensor.parameters();
    const bool has_all = std::all_of(parameters.begin(), parameters.end(), [&](int p) {
      return std::find(own.begin(), own.end(), p) != own.end();
    });
    const bool is_eye = sensor.sensor().is_camera() && sensor.sensor().delivers(Quantity::pixel);
    if (is_eye && has_all) return sensor.mount().parameter_prefix();
  }
  return {};
}

/// Whether residuals are larger than what robots are good to: a thousandth of their size, or a pixel.
[[nodiscard]] bool matters(const Assessment& step) {
  constexpr double kOfSize = 1e-3, kPixel = 1.0;
  return std::any_of(step.noise.begin(), step.noise.end(), [&](const BlockNoise& noise) {
    const double distance = noise.sigma * std::sqrt(static_cast<double>(noise.components));
    return distance > (noise.unit == "m" ? kOfSize * step.size : kPixel);
  });
}

/// What is left of the noise by what is named already.
[[nodiscard]] double known_to_leave(const Assessment& step) {
  return step.systematic ? step.systematic->noise_left : 1.0;
}

}  // namespace
}  // namespace detail

WouldHelp would_help(const Config& config, const Robot& robot, std::span<const Sample> samples,
                     const Calibration& calibration, const CalibrationResult& result) {
  constexpr std::size_t kFewest = 10, kMost = 2000;  // samples
  const bool fits = result.converged && config.steps.size() == 1 && calibration.steps.size() == 1;
  if (!fits || samples.size() < kFewest) return {};
  const std::vector<Sample> some = detail::some_of(samples, kMost);
  Diagnostics ignored;
  Calibration wide = assemble(with_all_candidates(config, robot, some), robot, some, ignored);
  if (!ignored.errors.empty() || wide.steps.size() != 1) return {};
  const AnyProblem& problem = *wide.steps.front().problem;
  if (are_one_pose(problem, some)) return {};  // the verdict says so
  for (const Parameter& p : result.table) {
    const int index = wide.table.find(p.name);
    if (index >= 0) wide.table[index].value = p.value;
  }
  wide.steps.front().unknown_frames.clear();  // they are known by now
  wide.steps.front().assignments.clear();
  const std::vector<int> base = detail::free_in(wide.table, calibration);
  const auto is_free = [&](int p) { return std::find(base.begin(), base.end(), p) != base.end(); };
  std::vector<IdentifyCandidate> candidates = identify_task(config, problem, some).candidates;
  std::erase_if(candidates, [&](const IdentifyCandidate& candidate) {
    return std::any_of(candidate.parameters.begin(), candidate.parameters.end(), is_free);
  });
  const Identified found = most_helpful(wide, some, base, candidates);
  const auto error = [&](std::size_t step) {
    return reading(found.steps[step].held_out, found.unit) +
           (problem.num_terms() > 1 ? " x noise" : "");
  };
  constexpr double kMuch = 0.9;
  WouldHelp help;
  for (std::size_t i = 1;
       i < found.steps.size() && found.steps[i].held_out < kMuch * found.steps[i - 1].held_out;
       ++i) {
    const IdentifyCandidate& candidate = candidates[static_cast<std::size_t>(found.chosen[i - 1])];
    const std::string name = candidate_name(candidate, wide.table);
    const std::string camera = detail::owning_camera(problem, candidate.parameters);
    help.camera = i == 1 || help.camera == camera ? camera : "";
    if (i == 1) help.first_left = found.steps[i].held_out / found.steps[0].held_out;
    help.left = found.steps[i].held_out / found.steps[0].held_out;
    help.sentences.push_back(i == 1
                                 ? "freeing " + name + " lowers the error on held-out poses from " +
                                       error(0) + " to " + error(1)
                                 : "and with it " + name + " to " + error(i));
  }
  return help;
}

void judge_help(const WouldHelp& help, const Assessment& step, Judgement& judgement) {
  constexpr double kLensIsWrong = 0.7, kHeldIsWrong = 0.75;  // of the error on held-out poses
  if (help.camera.empty()) {
    const double most = kHeldIsWrong * detail::known_to_leave(step);
    if (help.first_left >= most || !detail::matters(step)) return;
    judgement.add_causes(
        Grade::use_with_care,
        {fmt::format("{}: what is held is wrong; free it, or is the URDF of another "
                     "robot?",
                     fmt::join(help.sentences, ", "))});
    return;
  }
  if (help.left >= kLensIsWrong) return;
  judgement.add(Grade::use_with_care,
                fmt::format("the lens of '{}' is at fault: its intrinsics are not those given; {}",
                            help.camera, fmt::join(help.sentences, ", ")),
                {Remedy::Kind::mend});
}

}  // namespace kinecal
