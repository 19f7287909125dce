// Samples that are alike in one joint, and poses that are not.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "support/noisy_scene.hpp"

namespace kinecal::test {

/// A scene of which only those samples are left in which a joint is lowest.
struct AlikeSamples {
  NoisyScene scene;
  std::vector<Sample> others;  ///< what was taken out

  /// @param count  samples that are left, of ten times as many
  AlikeSamples(int count, const std::string& joint) : scene(10 * count) {
    std::vector<Sample>& all = scene.samples;
    std::stable_sort(all.begin(), all.end(), [&](const Sample& a, const Sample& b) {
      return a.position(joint).value() < b.position(joint).value();
    });
    others.assign(all.begin() + count, all.end());
    all.resize(static_cast<std::size_t>(count));
  }
};

}  // namespace kinecal::test
