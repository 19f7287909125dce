// What may be wrong with a robot, as candidates, and a configuration of those that samples support.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/trust/search/identify.hpp"

namespace kinecal {

/// A configuration that frees everything which may be wrong, so that its problem has all parameters: offsets,
/// frames and joint models of all joints that move a sensor or target, and all parameters of sensors.
/// @param config   of one step
/// @param samples  decide which models are candidates: backlash needs joints that came from both sides, a lag
///                 needs velocities
[[nodiscard]] Config with_all_candidates(const Config& config, const Robot& robot,
                                         std::span<const Sample> samples);

/// What the search begins with, and what it may free.
struct IdentifyTask {
  std::vector<int>
      base;  ///< table indices: poses that the URDF does not have, mounts that are free in `config`, and
             ///< parameters of error blocks
  std::vector<IdentifyCandidate> candidates;
};

/// @param config   the configuration whose models and error blocks are kept
/// @param geometry_only  without joint models, which a URDF cannot hold
/// @param problem  of with_all_candidates()
[[nodiscard]] IdentifyTask identify_task(const Config& config, const AnyProblem& problem,
                                         std::span<const Sample> samples,
                                         bool geometry_only = false);

/// "elbow_joint", "frame of tool_joint", or "frame of tool_joint: x y z" of what is freed in part.
[[nodiscard]] std::string candidate_name(const IdentifyCandidate& candidate,
                                         const ParameterTable& table);

/// The configuration that frees what was found.
[[nodiscard]] Config identified_config(const Config& config, const IdentifyTask& task,
                                       const Identified& found, const AnyProblem& problem);

}  // namespace kinecal
