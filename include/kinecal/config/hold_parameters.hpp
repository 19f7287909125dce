// Holds parameters that a configuration frees.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/config/config.hpp"

namespace kinecal {

/// Holds parameters at their initial values: no step frees them any more.
/// @param names        of free parameters: "elbow_flex_joint", "gripper_led_frame_x"; or of a free frame: all of it
/// @param diagnostics  receives an error for a name that no step frees, with the nearest free one
void hold_parameters(Config& config, const std::vector<std::string>& names,
                     Diagnostics& diagnostics);

}  // namespace kinecal
