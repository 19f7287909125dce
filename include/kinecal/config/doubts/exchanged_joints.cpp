// Definitions of exchanged_joints.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/exchanged_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace kinecal::detail {

bool are_many(std::size_t count, std::size_t all) {
  return 20 * count >= all && (count >= 2 || all == 1);
}

bool explains(std::size_t before, std::size_t after, std::size_t all) {
  return 50 * after <= all && 5 * after <= before;
}

std::size_t count_outside(const UsedJoint& limits, const UsedJoint& of) {
  return static_cast<std::size_t>(
      std::count_if(of.positions.begin(), of.positions.end(),
                    [&](double position) { return is_outside(limits, position); }));
}

bool fits_negated(const UsedJoint& joint) {
  UsedJoint negated = joint;
  for (double& position : negated.positions) position = -position;
  return explains(count_outside(joint, joint), count_outside(joint, negated),
                  joint.positions.size());
}

bool is_one_turned(std::span<const UsedJoint> joints) {
  int outside = 0, turned = 0;
  for (const UsedJoint& joint : joints) {
    if (!are_many(count_outside(joint, joint), joint.positions.size())) continue;
    ++outside;
    turned += turn_into_limits(joint) ? 1 : 0;
  }
  return outside == 1 && turned == 1;
}

std::size_t count_all_outside(std::span<const UsedJoint> joints) {
  std::size_t outside = 0;
  for (const UsedJoint& joint : joints) outside += count_outside(joint, joint);
  return outside;
}

std::vector<ExchangedPair> exchanged_pairs(std::span<const UsedJoint> joints) {
  std::vector<ExchangedPair> pairs;
  const std::size_t outside = count_all_outside(joints);
  for (std::size_t a = 0; a < joints.size(); ++a) {
    for (std::size_t b = a + 1; b < joints.size(); ++b) {
      const UsedJoint &first = joints[a], &second = joints[b];
      if (turns(first.joint.type) != turns(second.joint.type)) continue;
      const std::size_t of_a = count_outside(first, first), of_b = count_outside(second, second);
      const std::size_t all = first.positions.size() + second.positions.size();
      const std::size_t after = count_outside(first, second) + count_outside(second, first);
      const std::size_t of_others = outside - of_a - of_b;
      if (!are_many(of_a + of_b, all / 2) || !explains(outside, after + of_others, all)) continue;
      pairs.push_back({a, b, of_a + of_b, of_a > 0 && of_b > 0});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const ExchangedPair& x, const ExchangedPair& y) {
    return x.both_outside != y.both_outside ? x.both_outside : x.outside > y.outside;
  });
  return pairs;
}

std::vector<std::size_t> report_exchanged(std::span<const UsedJoint> joints,
                                          std::span<const Sample> samples,
                                          Diagnostics& diagnostics) {
  const std::vector<ExchangedPair> pairs = exchanged_pairs(joints);
  if (pairs.empty()) return {};
  const ExchangedPair& best = pairs.front();
  const bool a_is_outside = count_outside(joints[best.a], joints[best.a]) > 0;
  const UsedJoint& shown = joints[a_is_outside ? best.a : best.b];
  std::size_t at = 0;
  while (!is_outside(shown, shown.positions[at])) ++at;
  std::string others;
  for (std::size_t i = 1; i < std::min<std::size_t>(pairs.size(), 3); ++i) {
    others += fmt::format("{}'{}' and '{}'", i == 1 ? "; others that fit: " : ", ",
                          joints[pairs[i].a].joint.name, joints[pairs[i].b].joint.name);
  }
  const std::string text = fmt::format(
      "position of '{}' is {:.4g}; its limits are {}; all positions of '{}' and '{}' are within "
      "their limits if these two names are exchanged{}; compare the order of names and positions "
      "with the driver",
      shown.joint.name, shown.positions[at], shown.limits_text(), joints[best.a].joint.name,
      joints[best.b].joint.name, others);
  const std::size_t half = shown.positions.size() / 2;
  const SourceLocation place = place_of(samples, shown.samples[at]);
  if (best.both_outside || best.outside > half) {
    diagnostics.error(place, text);
  } else {
    diagnostics.refutable_doubt(place, text);
  }
  return {best.a, best.b};
}

std::vector<std::size_t> report_negated(std::span<const UsedJoint> joints,
                                        std::span<const Sample> samples, Diagnostics& diagnostics) {
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const UsedJoint& joint = joints[j];
    const std::size_t all = joint.positions.size(), outside = count_outside(joint, joint);
    if (!are_many(outside, all) || 50 * (count_all_outside(joints) - outside) > all) continue;
    if (!fits_negated(joint)) continue;
    std::size_t at = 0;
    while (!is_outside(joint, joint.positions[at])) ++at;
    const SourceLocation place = place_of(samples, joint.samples[at]);
    const std::string text = fmt::format(
        "position of '{}' is {:.4g}; its limits are {}; all of its positions are within them with "
        "the other sign; compare the direction of the joint with the driver",
        joint.joint.name, joint.positions[at], joint.limits_text());
    if (2 * outside > all) {
      diagnostics.error(place, text);
    } else {
      diagnostics.refutable_doubt(place, text);
    }
    return {j};
  }
  return {};
}

}  // namespace kinecal::detail
