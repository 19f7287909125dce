// How joints moved in a recording: the direction from which each came to a pose, velocities, and what the sample before
// had.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The way of a joint through the poses of a recording.
struct JointWay {
  std::optional<double> stood = {};  ///< where it stood last, radians or metres
  double move = 0.0;                 ///< how far it has come from where it stood before

  /// Passes the next position.  Smaller distances than 1e-3 are no move: the joint keeps the
  /// direction in which it moved last.
  void pass(double position) {
    constexpr double kStill = 1e-3;  // radians or metres
    if (stood && std::abs(position - *stood) <= kStill) return;
    if (stood) move = position - *stood;
    stood = position;
  }
};

/// Sets Sample::joint_moves: see JointWay.
/// @param samples  of one recording, in its order
inline void set_joint_moves(std::span<Sample> samples) {
  std::map<std::string, JointWay> ways;
  for (Sample& sample : samples) {
    sample.joint_moves.assign(sample.joint_names.size(), 0.0);
    for (std::size_t i = 0; i < sample.joint_names.size() && i < sample.joint_positions.size();
         ++i) {
      JointWay& way = ways[sample.joint_names[i]];
      way.pass(sample.joint_positions[i]);
      sample.joint_moves[i] = way.move;
    }
  }
}

/// The recording of a sample: its source without the line; empty: unknown.
[[nodiscard]] inline std::string recording_of(const Sample& sample) {
  const std::size_t colon = sample.source.rfind(':');
  return colon == std::string::npos ? "" : sample.source.substr(0, colon);
}

/// Sets Sample::before, for error blocks that look at the sample before: the last one of the same recording and run (kRun) in
/// which none of the numbers that they look at is missing, such as a wall that was not seen.
/// @param samples  in the order of their recordings
/// @param names    of the conditions and joints that the blocks look at
inline void set_before(std::span<Sample> samples, const std::set<std::string>& names = {}) {
  const auto run_of = [](const Sample& sample) {
    const auto run = sample.conditions.find(kRun);
    return std::pair(recording_of(sample),
                     run == sample.conditions.end() ? std::optional<double>() : run->second);
  };
  const Sample* last = nullptr;
  for (Sample& sample : samples) {
    sample.before.clear();
    if (last != nullptr && run_of(*last) == run_of(sample)) {
      sample.before = last->conditions;
      for (std::size_t j = 0; j < std::min(last->joint_names.size(), last->joint_positions.size());
           ++j) {
        sample.before.emplace(last->joint_names[j], last->joint_positions[j]);
      }
    }
    const bool is_missing = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      const auto found = sample.conditions.find(name);
      return found != sample.conditions.end() && std::isnan(found->second);
    });
    if (!is_missing) last = &sample;
  }
}

/// Speed of the fastest joint of a sample, rad/s or m/s; nullopt if it has no velocities.
/// @param left_out  joints that do not count, such as those that slide
[[nodiscard]] inline std::optional<double> fastest_joint(
    const Sample& sample, const std::set<std::string>& left_out = {}) {
  std::optional<double> fastest;
  for (std::size_t i = 0; i < sample.joint_names.size() && i < sample.joint_velocities.size();
       ++i) {
    if (left_out.count(sample.joint_names[i]) > 0) continue;
    fastest = std::max(fastest.value_or(0.0), std::abs(sample.joint_velocities[i]));
  }
  return fastest;
}

/// Sets Sample::joint_velocities from neighbours in time, where a recording has none: the slope from
/// the sample before to the one after, of those within 0.2 s that have the same joints.
/// @param samples  in the order of the recording
inline void set_joint_velocities(std::span<Sample> samples) {
  constexpr std::chrono::milliseconds kNear(200);
  for (const Sample& sample : samples) {
    if (!sample.stamp || !sample.joint_velocities.empty()) return;
  }
  const auto near = [&](const Sample& before, const Sample& after) {
    const auto gap = *after.stamp - *before.stamp;
    const std::size_t joints = before.joint_names.size();
    return gap.count() > 0 && gap <= kNear && after.joint_names == before.joint_names &&
           before.joint_positions.size() == joints && after.joint_positions.size() == joints;
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool has_before = i > 0 && near(samples[i - 1], samples[i]);
    const bool has_after = i + 1 < samples.size() && near(samples[i], samples[i + 1]);
    if (!has_before && !has_after) continue;
    const Sample &before = samples[has_before ? i - 1 : i], &after = samples[has_after ? i + 1 : i];
    const double seconds = std::chrono::duration<double>(*after.stamp - *before.stamp).count();
    for (std::size_t j = 0; j < before.joint_positions.size(); ++j) {
      samples[i].joint_velocities.push_back((after.joint_positions[j] - before.joint_positions[j]) /
                                            seconds);
    }
  }
}

}  // namespace kinecal
