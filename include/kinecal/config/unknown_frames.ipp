// Free frames without a configured pose, and a few samples for the search.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "kinecal/config/config.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/solve/fit_frames.hpp"

namespace kinecal::detail {

/// Names of frames that a previous step has found.
[[nodiscard]] inline std::set<std::string> found_frames(const Config& config,
                                                        const StepConfig& until) {
  std::set<std::string> found;
  for (const StepConfig& step : config.steps) {
    if (&step == &until) break;
    for (const FreeFrameConfig& frame : step.free_frames) found.insert(frame.name);
  }
  return found;
}

/// True if the configuration gives a frame's pose, in this step or before it.
[[nodiscard]] inline bool is_given(const Config& config, const StepConfig& until,
                                   const std::string& frame) {
  for (const StepConfig& step : config.steps) {
    for (const FrameInitialValueConfig& value : step.frame_initial_values) {
      if (value.name == frame && !(value.xyz.isZero() && value.rpy.isZero())) return true;
    }
    for (const InitialValueConfig& value : step.initial_values) {
      for (const auto axis : kFrameAxes) {
        if (value.name == parameter_name(frame, axis) && value.value != 0.0) return true;
      }
    }
    if (&step == &until) break;
  }
  return false;
}

/// True for a joint whose pose may be a placeholder: it is fixed, free in all axes, and not held by
/// a prior.
[[nodiscard]] inline bool may_be_anywhere(const Joint& joint, const FreeFrameConfig& frame,
                                          const StepConfig& step) {
  return joint.type == JointType::fixed &&
         std::all_of(frame.axes.begin(), frame.axes.end(), [](bool free) { return free; }) &&
         std::none_of(step.error_blocks.begin(), step.error_blocks.end(),
                      [&](const BlockConfig& block) { return block.param == frame.name; });
}

/// The free frames of a step whose pose may need a search: virtual frames, and fixed joints with
/// placeholders in the URDF.  A zero pose never counts as a guess.
[[nodiscard]] inline std::vector<UnknownFrame> unknown_frames(const Config& config,
                                                              const StepConfig& step,
                                                              const Robot& robot,
                                                              const ParameterTable& table,
                                                              const FreeSet& free) {
  const std::set<std::string> found_before = found_frames(config, step);
  std::vector<UnknownFrame> unknown;
  for (const FreeFrameConfig& frame : step.free_frames) {
    if (found_before.contains(frame.name)) continue;
    bool has_guess = is_given(config, step, frame.name);
    if (robot.has_joint(frame.name)) {
      const Joint& joint = robot.joint(frame.name);
      if (!may_be_anywhere(joint, frame, step)) continue;
      has_guess =
          has_guess || !joint.origin.rotation.isIdentity() || !joint.origin.translation.isZero();
    }
    UnknownFrame found = unknown_frame(frame.name, table, free, has_guess);
    const bool any =
        std::any_of(found.axes.begin(), found.axes.end(), [](int p) { return p >= 0; });
    if (any) unknown.push_back(std::move(found));
  }
  const bool turns = std::any_of(unknown.begin(), unknown.end(),
                                 [](const UnknownFrame& frame) { return frame.turns(); });
  return turns ? unknown : std::vector<UnknownFrame>();
}

}  // namespace kinecal::detail
