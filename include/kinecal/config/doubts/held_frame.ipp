// A frame of the robot that is held and whose change explains residuals: a link that is longer than in the URDF, an
// axis that is not where the drawing has it.
//
// All frames of joints are freed beside the free parameters: see held_changes.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "kinecal/trust/held_changes.hpp"

namespace kinecal::detail {

/// Names of the joints on the chains of a problem's sensors.
[[nodiscard]] inline std::set<std::string> joints_of_sensors(const AnyProblem& problem) {
  std::set<std::string> names;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const Joint* joint : joints_to_root(problem.robot(), sensor.mount().frame)) {
      names.insert(joint->name);
    }
  }
  return names;
}

/// The last step with all axes of the frames of these joints free.
[[nodiscard]] inline Config with_free_frames(Config config, const std::set<std::string>& joints) {
  StepConfig& step = config.steps.back();
  constexpr std::array<bool, 6> kAll = {true, true, true, true, true, true};
  std::set<std::string> missing = joints;
  for (FreeFrameConfig& frame : step.free_frames) {
    if (missing.erase(frame.name) == 0 || frame.is_fixed) continue;
    frame.axes = kAll;
  }
  for (const std::string& joint : missing) step.free_frames.push_back({joint, kAll, step.place});
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

/// A held frame whose change explains residuals, as a sentence; nullopt if none does.
[[nodiscard]] inline std::optional<std::string> held_frame(const CalibrationInput& input,
                                                           const JudgedResult& judged) {
  if (!matters(judged.assessments.back())) return {};
  const CalibrationStep& last = input.calibration.steps.back();
  const std::set<std::string> joints = joints_of_sensors(*last.problem);
  Diagnostics quiet;
  const Calibration more =
      assemble(with_free_frames(input.config, joints), input.robot, input.samples, quiet);
  if (!quiet.errors.empty() || more.steps.size() != input.calibration.steps.size()) return {};
  const AnyProblem& problem = *more.steps.back().problem;
  if (problem.num_terms() != last.problem->num_terms()) return {};
  for (int t = 0; t < problem.num_terms(); ++t) {
    more.steps.back().problem->set_sigma(t, last.problem->term(t).sigma);
  }
  std::vector<double> values;
  for (int p = 0; p < problem.table().size(); ++p) {
    const int known = judged.result.table.find(problem.table()[p].name);
    values.push_back(known >= 0 ? judged.result.table[known].value : problem.table()[p].value);
  }
  std::set<int> free;
  for (const int p : last.free.parameters()) {
    free.insert(problem.table().find(last.problem->table()[p].name));
  }
  std::vector<HeldGroup> groups;
  for (const std::string& joint : joints) {
    for (const bool rotation : {false, true}) {
      HeldGroup group{joint, rotation, {}};
      for (std::size_t i = 0; i < 3; ++i) {
        const int p =
            problem.table().find(parameter_name(joint, kFrameAxes[i + (rotation ? 3 : 0)]));
        if (p >= 0 && !free.contains(p)) group.parameters.push_back(p);
      }
      if (!group.parameters.empty()) groups.push_back(group);
    }
  }
  constexpr double kLeft = 0.75;
  const auto& pattern = judged.assessments.back().pattern;
  double best = pattern ? kLeft * std::min(1.0, pattern->noise_left) : kLeft;
  std::optional<std::string> sentence;
  std::vector<std::vector<int>> held;
  for (const HeldGroup& group : groups) held.push_back(group.parameters);
  const std::vector<HeldChange> changes =
      held_changes(problem, more.steps.back().free, values, free, held);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!(changes[g].noise_left < best)) continue;
    best = changes[g].noise_left;
    sentence = fmt::format(
        "with '{}' {} from where the URDF has it, which is held, the noise falls to {:.3g} %; free "
        "its frame, or is the URDF of another robot?",
        groups[g].joint,
        groups[g].rotation
            ? fmt::format("turned by {:.2g} deg", changes[g].size * 180.0 / std::numbers::pi)
            : fmt::format("{:.2g} mm away", 1e3 * changes[g].size),
        1e2 * best);
  }
  return sentence;
}

}  // namespace kinecal::detail
