// Compares positions of a joint with its limits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kinecal/config/doubts/used_joints.hpp"

namespace kinecal::detail {

/// By how much a position is outside the limits, radians or metres; 0 inside.
[[nodiscard]] double excess_of(const UsedJoint& joint, double position);

/// True if a position is further outside than offsets of real robots explain.  Full turns do not
/// count.
[[nodiscard]] bool is_outside(const UsedJoint& joint, double position);

/// True if all positions are within the limits when a turn is added, as far as limits are exact.
[[nodiscard]] bool fits_turned(const UsedJoint& joint, double turn);

/// The smallest quarter or half turn that brings all positions of a joint into its limits; nullopt
/// if none does.
[[nodiscard]] std::optional<double> turn_into_limits(const UsedJoint& joint);

}  // namespace kinecal::detail
