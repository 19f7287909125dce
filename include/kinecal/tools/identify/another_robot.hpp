// Whether samples are of another robot than the URDF: then a search explains it by whatever there is, or not at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/tools/identify/robot_search.hpp"

namespace kinecal {

/// Why the samples seem to be of another robot, a sentence; empty if they do not.  Either more than 10 mm or 30 px are left
/// whatever is freed; or an arm's length would be 20 mm off, or an axis between its joints 10 degrees: robots of one
/// make differ by less than a tenth of that.  Zeros and mounts may be off by anything.
[[nodiscard]] std::string another_robot(const RobotSearch& search);

}  // namespace kinecal
