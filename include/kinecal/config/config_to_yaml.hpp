// Writes a configuration of one step as YAML, with comments.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "kinecal/config/config.hpp"

namespace kinecal {

/// The text of a configuration, which read_config() reads as the same.
/// @param config  of one step
/// @param title   comment at the top, lines without "#"
/// @param why     comments, by names of free parameters, also of those of frames: "elbow_joint_x"
/// @throws std::invalid_argument  if it has not one step
[[nodiscard]] std::string config_to_yaml(const Config& config, const std::string& title,
                                         const std::map<std::string, std::string>& why = {});

}  // namespace kinecal
