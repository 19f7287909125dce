// The configuration with which cameras alone are calibrated: `kinecal init --cameras`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinecal {

/// The configuration of cameras on one body, which see a board that somebody holds.
/// @param cameras  their names; the first one is the base
/// @throws std::invalid_argument  if it is missing, or two have the same name
[[nodiscard]] std::string initial_cameras(const std::vector<std::string>& cameras);

}  // namespace kinecal
