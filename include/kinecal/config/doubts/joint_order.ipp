// Positions under the names of another order of the joints: that of the alphabet, or reversed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "kinecal/config/doubts/exchanged_joints.ipp"

namespace kinecal::detail {

/// Another order of the joints: joint j gets the positions named after joint order[j].
struct JointOrder {
  std::vector<std::size_t> order;
  const char* how;
};

/// Orders that drivers and people commonly produce, other than the one as given.
[[nodiscard]] inline std::vector<JointOrder> joint_orders(std::span<const UsedJoint> joints) {
  std::vector<std::size_t> sorted(joints.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::vector<std::size_t> reversed(sorted.rbegin(), sorted.rend()), inverse = sorted;
  std::sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) {
    return joints[a].joint.name < joints[b].joint.name;
  });
  for (std::size_t i = 0; i < sorted.size(); ++i) inverse[sorted[i]] = i;
  std::vector<JointOrder> orders{
      {sorted, "if they are in the order of the chain and the names in that of the alphabet"},
      {inverse, "if they are in the order of the alphabet and the names in that of the chain"},
      {reversed, "if they are in reverse order"}};
  std::erase_if(orders, [](const JointOrder& order) {
    return std::is_sorted(order.order.begin(), order.order.end());
  });
  return orders;
}

/// Error: names and positions are in different orders.
/// @returns  true if it was reported
inline bool report_order(std::span<const UsedJoint> joints, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  std::size_t all = 0;
  for (const UsedJoint& joint : joints) all += joint.positions.size();
  const auto first = std::find_if(joints.begin(), joints.end(), [](const UsedJoint& joint) {
    return count_outside(joint, joint) > 0;
  });
  const std::size_t before = count_all_outside(joints);
  if (first == joints.end() || !are_many(before, samples.size())) return false;
  for (const auto& [order, how] : joint_orders(joints)) {
    std::size_t after = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      after += count_outside(joints[j], joints[order[j]]);
    }
    if (!explains(before, after, all)) continue;
    std::size_t at = 0;
    while (!is_outside(*first, first->positions[at])) ++at;
    diagnostics.error(
        place_of(samples, first->samples[at]),
        fmt::format("position of '{}' is {:.4g}; its limits are {}; all positions are within their "
                    "limits {}; compare the order of names and positions with the driver",
                    first->joint.name, first->positions[at], first->limits_text(), how));
    return true;
  }
  return false;
}

}  // namespace kinecal::detail
