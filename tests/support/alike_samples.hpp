// Samples of poses that are alike, and other poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "support/noisy_scene.hpp"

namespace kinecal::test {

/// A scene of which only those samples are left whose poses are nearest to the first one's.
struct AlikeSamples {
  NoisyScene scene;
  std::vector<Sample> others;  ///< what was taken out

  /// @param count  samples that are left, of ten times as many
  explicit AlikeSamples(int count) : scene(10 * count) {
    std::vector<Sample>& all = scene.samples;
    const std::vector<double> first = all.front().joint_positions;
    const auto distance = [&](const Sample& sample) {
      double sum = 0.0;
      for (std::size_t i = 0; i < first.size(); ++i) {
        sum += (sample.joint_positions[i] - first[i]) * (sample.joint_positions[i] - first[i]);
      }
      return sum;
    };
    std::stable_sort(all.begin(), all.end(),
                     [&](const Sample& a, const Sample& b) { return distance(a) < distance(b); });
    others.assign(all.begin() + count, all.end());
    all.resize(static_cast<std::size_t>(count));
  }
};

}  // namespace kinecal::test
