// Which targets of `kinecal init` a robot can be measured against.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// Proposed cameras that can see a target: those that do not move with the arm that holds it.
/// @param arm  link at its end; empty: any of the proposed ones
[[nodiscard]] std::vector<std::string> cameras_for(const Robot& robot, InitTarget target,
                                                   const std::string& arm);

/// Why a robot cannot be measured against a target, found before any question; empty if it can.
/// @param arm, camera  links, if they are known
[[nodiscard]] std::string why_no_target(const Robot& robot, InitTarget target,
                                        const std::string& arm, const std::string& camera);

}  // namespace kinecal
