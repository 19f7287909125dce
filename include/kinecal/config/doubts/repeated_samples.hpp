// Finds samples that are copies of others, and samples of one pose that contradict each other.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// Error: all samples are the same.  Doubt (warning if few): some are copies.  Doubt: at equal
/// joint positions a sensor sees something else although the target is the same, so the robot was
/// moving or the target slipped.
/// @param joints  from used_joints(): the others do not matter
/// @returns       number of different samples
std::size_t check_repeated_samples(const Config& config, std::span<const UsedJoint> joints,
                                   std::span<const Sample> samples, Diagnostics& diagnostics);

}  // namespace kinecal::detail
