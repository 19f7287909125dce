// A frame of the robot that is held and whose change explains residuals: a link that is longer than in the URDF, an
// axis that is not where the drawing has it.
//
// All frames of joints are freed beside the free parameters: see held_changes.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "kinecal/trust/held_changes.hpp"

namespace kinecal::detail {

/// The last step with all axes of the frames of these joints free.
[[nodiscard]] inline Config with_free_frames(Config config,
                                             const std::vector<const Joint*>& joints) {
  StepConfig& step = config.steps.back();
  constexpr std::array<bool, 6> kAll = {true, true, true, true, true, true};
  for (const Joint* joint : joints) {
    if (joint->type == JointType::floating) continue;  // its pose is measured
    const auto known =
        std::find_if(step.free_frames.begin(), step.free_frames.end(),
                     [&](const FreeFrameConfig& frame) { return frame.name == joint->name; });
    if (known == step.free_frames.end()) {
      step.free_frames.push_back({joint->name, kAll, step.place});
    } else if (!known->is_fixed) {
      known->axes = kAll;
    }
  }
  return config;
}

/// The held parameters of a joint's frame: its translation or its rotation.
struct HeldGroup {
  std::string joint;
  bool rotation = false;
  std::vector<int> parameters;  ///< table indices
};

/// Whether residuals are larger than what robots are good to: a thousandth of their size, or a pixel.
[[nodiscard]] inline bool matters(const Assessment& step) {
  constexpr double kOfSize = 1e-3, kPixel = 1.0;
  return std::any_of(step.noise.begin(), step.noise.end(), [&](const BlockNoise& noise) {
    const double distance = noise.sigma * std::sqrt(static_cast<double>(noise.components));
    return distance > (noise.unit == "m" ? kOfSize * step.size : kPixel);
  });
}

/// The held translations and rotations of joints.
/// @param free  table indices of the parameters that are not held
[[nodiscard]] inline std::vector<HeldGroup> held_groups(const ParameterTable& table,
                                                        const std::vector<const Joint*>& joints,
                                                        const std::set<int>& free) {
  std::vector<HeldGroup> groups;
  for (const Joint* joint : joints) {
    for (const bool rotation : {false, true}) {
      HeldGroup group{joint->name, rotation, {}};
      for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = kFrameAxes[i + (rotation ? 3 : 0)];
        const int p = table.find(parameter_name(joint->name, axis));
        if (p >= 0 && !free.contains(p)) group.parameters.push_back(p);
      }
      if (!group.parameters.empty()) groups.push_back(group);
    }
  }
  return groups;
}

/// The largest change among those that leave less noise than `most`, as a sentence.
[[nodiscard]] inline std::optional<std::string> best_sentence(
    const std::vector<HeldGroup>& groups, const std::vector<HeldChange>& changes, double most) {
  std::optional<std::string> sentence;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!(changes[g].noise_left < most)) continue;
    most = changes[g].noise_left;
    const std::string size =
        groups[g].rotation
            ? fmt::format("turned by {:.2g} deg", changes[g].size * 180.0 / std::numbers::pi)
            : fmt::format("{:.2g} mm away", 1e3 * changes[g].size);
    sentence = fmt::format(
        "with '{}' {} from where the URDF has it, which is held, the noise falls to {:.3g} %; free "
        "its frame, or is the URDF of another robot?",
        groups[g].joint, size, 1e2 * most);
  }
  return sentence;
}

/// A held frame whose change explains residuals, as a sentence; nullopt if none does.
[[nodiscard]] inline std::optional<std::string> held_frame(const CalibrationInput& input,
                                                           const JudgedResult& judged) {
  if (!matters(judged.assessments.back())) return {};
  const CalibrationStep& last = input.calibration.steps.back();
  const std::vector<const Joint*> joints = joints_between(input.config, input.robot);
  Diagnostics quiet;
  const Calibration more =
      assemble(with_free_frames(input.config, joints), input.robot, input.samples, quiet);
  if (!quiet.errors.empty() || more.steps.size() != input.calibration.steps.size()) return {};
  AnyProblem& problem = *more.steps.back().problem;
  if (problem.num_terms() != last.problem->num_terms()) return {};
  for (int t = 0; t < problem.num_terms(); ++t) {
    problem.set_sigma(t, last.problem->term(t).sigma);
  }
  std::vector<double> values;
  for (const Parameter& parameter : problem.table()) {
    const int known = judged.result.table.find(parameter.name);
    values.push_back(known >= 0 ? judged.result.table[known].value : parameter.value);
  }
  std::set<int> free;
  for (const int p : last.free.parameters()) {
    free.insert(problem.table().find(last.problem->table()[p].name));
  }
  const std::vector<HeldGroup> groups = held_groups(problem.table(), joints, free);
  std::vector<std::vector<int>> held;
  for (const HeldGroup& group : groups) held.push_back(group.parameters);
  constexpr double kLeft = 0.75;
  const auto& pattern = judged.assessments.back().pattern;
  const auto& lens = judged.assessments.back().lens;
  const double known = std::min(pattern ? pattern->noise_left : 1.0, lens ? lens->noise_left : 1.0);
  return best_sentence(groups, held_changes(problem, more.steps.back().free, values, free, held),
                       kLeft * std::min(1.0, known));
}

}  // namespace kinecal::detail
