// Two explanations of the same: which parameters they are, and a configuration that frees both, so that poses can be
// chosen which tell them apart (study/select_poses.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Two explanations, both free beside what a configuration frees.
struct Explanations {
  Config config;
  std::array<std::vector<std::string>, 2> parameters;  ///< of each
};

/// @param config  of one step
/// @param names   two candidates as `kinecal identify` names them, or a parameter of each
/// @throws InputError  if a name is unknown, or both are the same
[[nodiscard]] Explanations free_explanations(const Config& config, const Robot& robot,
                                             std::span<const Sample> samples,
                                             const std::vector<std::string>& names);

/// True if nothing limits where the robot may be seen: no sensor is a camera.
[[nodiscard]] bool sees_everywhere(const Config& config);

}  // namespace kinecal
