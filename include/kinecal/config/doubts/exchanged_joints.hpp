// Exchanged names of joints: positions outside the limits, but inside those of another joint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/config/doubts/joint_limits.hpp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// True if so many positions cannot be single bad captures.
[[nodiscard]] bool are_many(std::size_t count, std::size_t all);

/// True if so few positions are outside after a correction that it explains those outside before.
[[nodiscard]] bool explains(std::size_t before, std::size_t after, std::size_t all);

/// Number of positions of one joint that are outside the limits of another.
[[nodiscard]] std::size_t count_outside(const UsedJoint& limits, const UsedJoint& of);

/// True if the other sign explains positions outside the limits.
[[nodiscard]] bool fits_negated(const UsedJoint& joint);

/// True if one joint is outside its limits, and another zero of it explains that.
[[nodiscard]] bool is_one_turned(std::span<const UsedJoint> joints);

/// Two joints whose positions fit if their names are exchanged.
struct ExchangedPair {
  std::size_t a = 0, b = 0;
  std::size_t outside = 0;  ///< positions outside the limits as they are named
  bool both_outside = false;
};

/// Total number of positions outside the limits of their own joint.
[[nodiscard]] std::size_t count_all_outside(std::span<const UsedJoint> joints);

/// Pairs that explain all positions outside the limits, best explanation first.
[[nodiscard]] std::vector<ExchangedPair> exchanged_pairs(std::span<const UsedJoint> joints);

/// Error, or doubt if only few positions show it: names of two joints are exchanged.
/// @returns  indices of the reported joints
std::vector<std::size_t> report_exchanged(std::span<const UsedJoint> joints,
                                          std::span<const Sample> samples,
                                          Diagnostics& diagnostics);

/// Error, or doubt if only few positions show it: the positions of one joint have the wrong sign.
/// @returns  indices of the reported joints: none or one
std::vector<std::size_t> report_negated(std::span<const UsedJoint> joints,
                                        std::span<const Sample> samples, Diagnostics& diagnostics);

}  // namespace kinecal::detail
