// How often check_drift() is right: about robots that have not changed, and about joints that have slipped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "kinecal/trust/verify/drift.hpp"

namespace kinecal::test {

/// How many were found of how many.
struct Found {
  int found = 0, of = 0;
  void add(bool is_found) {
    found += is_found ? 1 : 0;
    ++of;
  }
};

/// Counts of some checks.
struct DriftCounts {
  Found alarms;        ///< rejected at 1 % though nothing has moved
  Found alarms_at_5;   ///< the same at 5 %
  Found half_degrees;  ///< slips by 0.5 degrees that move the features by five times the noise
  Found smallest;      ///< slips by what `Drift::visible` says

  /// Adds the checks of a scene.
  /// @param scene  RepeatedScene, TrackedArm or Redrawn
  template <class Scene>
  void add(Scene& scene) {
    constexpr double kLevel = 0.01, kHalfDegree = 0.5 * std::numbers::pi / 180.0, kTimes = 5.0;
    const Drift still = scene.check(kLevel);
    alarms.add(!still.holds);
    alarms_at_5.add(!scene.check(0.05).holds);
    const auto is_found = [&](const std::string& joint, double by) {
      scene.slip(joint, by);
      const bool found = !scene.check(kLevel).holds;
      scene.slip(joint, -by);
      return found;
    };
    for (const std::string& joint : scene.joint_names()) {
      if (scene.size_of(joint, kHalfDegree) < kTimes) continue;
      half_degrees.add(is_found(joint, kHalfDegree));
    }
    for (const SmallestChange& change : still.visible) {
      if (change.is_frame || change.unit != "rad" || !std::isfinite(change.size)) continue;
      smallest.add(is_found(change.owner, change.size));
    }
  }
};

}  // namespace kinecal::test
