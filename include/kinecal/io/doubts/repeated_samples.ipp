// Definitions of repeated_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/io/doubts/occurrences.hpp"
#include "kinecal/io/doubts/repeated_samples.hpp"

namespace kinecal::detail {

/// Indices of the samples of each pose: positions equal to 1e-5 rad or metres.
[[nodiscard]] inline std::vector<std::vector<std::size_t>> samples_by_pose(
    std::span<const UsedJoint> joints, std::size_t count) {
  constexpr double kSame = 1e-5, kLargest = 1e12;
  std::vector<std::vector<long long>> poses(count);
  for (const UsedJoint& joint : joints) {
    for (std::size_t i = 0; i < joint.positions.size(); ++i) {
      const double steps = joint.positions[i] / kSame;
      poses[joint.samples[i]].push_back(std::abs(steps) < kLargest ? std::llround(steps) : 0);
    }
  }
  std::map<std::vector<long long>, std::vector<std::size_t>> by_pose;
  for (std::size_t s = 0; s < count; ++s) by_pose[poses[s]].push_back(s);
  std::vector<std::vector<std::size_t>> groups;
  for (auto& [pose, of_pose] : by_pose) groups.push_back(std::move(of_pose));
  return groups;
}

/// The largest distance between the same features of two observations, metres or pixels; infinite
/// if they are not comparable.
[[nodiscard]] inline double change_between(const Observation& a, const Observation& b) {
  double most = 0.0;
  if (a.features.size() != b.features.size()) return HUGE_VAL;
  for (std::size_t i = 0; i < a.features.size(); ++i) {
    if (a.features[i].frame != b.features[i].frame) return HUGE_VAL;
    const auto &p = a.features[i].point, &q = b.features[i].point;
    if (!p.allFinite() || !q.allFinite()) {
      if (p.allFinite() != q.allFinite()) return HUGE_VAL;
      continue;
    }
    most = std::max(most, (p - q).norm());
  }
  return most;
}

/// True if the two samples have the same observations.
[[nodiscard]] inline bool are_copies(const Sample& a, const Sample& b) {
  if (a.observations.size() != b.observations.size() || a.conditions != b.conditions) return false;
  for (const Observation& seen : a.observations) {
    const Observation* other = b.observation(seen.sensor);
    if (other == nullptr || change_between(seen, *other) != 0.0) return false;
  }
  return true;
}

/// The sensor that sees something else while another one sees the same; nullptr if there is none.
/// @param pixels  names of the sensors whose features are pixels
[[nodiscard]] inline const Observation* contradiction(const Sample& a, const Sample& b,
                                                      const std::set<std::string>& pixels) {
  const Observation* changed = nullptr;
  std::size_t same = 0;
  for (const Observation& seen : a.observations) {
    const Observation* other = b.observation(seen.sensor);
    if (other == nullptr) return nullptr;
    const double change = change_between(seen, *other);
    if (change == HUGE_VAL) return nullptr;
    const double noise = pixels.contains(seen.sensor) ? 5.0 : 0.005;  // pixels or metres
    if (change == 0.0) ++same;
    if (change > noise) changed = &seen;
  }
  return same > 0 ? changed : nullptr;
}

KINECAL_INLINE std::size_t check_repeated_samples(const Config& config,
                                                  std::span<const UsedJoint> joints,
                                                  std::span<const Sample> samples,
                                                  Diagnostics& diagnostics) {
  const std::set<std::string> pixels = pixel_models(config);
  Occurrences copies, contradictions;
  std::size_t copied = 0, before = 0;
  std::string sensor;
  for (const auto& group : samples_by_pose(joints, samples.size())) {
    for (std::size_t i = 1; i < group.size(); ++i) {
      const Sample& sample = samples[group[i]];
      const auto same = std::find_if(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(i),
                                     [&](std::size_t s) { return are_copies(samples[s], sample); });
      if (same != group.begin() + static_cast<std::ptrdiff_t>(i)) {
        if (copies.count == 0) copied = *same;
        copies.add(group[i]);
      } else if (const Observation* seen = contradiction(sample, samples[group[0]], pixels)) {
        if (contradictions.count == 0) sensor = seen->sensor, before = group[0];
        contradictions.add(group[i]);
      }
    }
  }
  const std::size_t distinct = samples.size() - copies.count;
  if (copies.count > 0) {
    const SourceLocation place = place_of(samples, copies.first);
    const std::string text = fmt::format("the sample is a copy of that at {}{}",
                                         place_of(samples, copied).str(), copies.others());
    if (distinct == 1) {
      diagnostics.error(place, fmt::format("all {} samples are the same one: joint positions and "
                                           "features are equal; record different poses",
                                           samples.size()));
    } else if (50 * copies.count > samples.size()) {
      diagnostics.doubt(place, text + "; copies count twice and say nothing new; remove them");
    } else {
      diagnostics.warning(place, text);
    }
  }
  if (contradictions.count > 0) {
    diagnostics.doubt(
        place_of(samples, contradictions.first),
        fmt::format("the joint positions are those of {}, but sensor '{}' sees "
                    "something else{}; was the robot moving, or did the target slip?",
                    place_of(samples, before).str(), sensor, contradictions.others()));
  }
  return distinct;
}

}  // namespace kinecal::detail
