// Definitions of unseen_corners.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/unseen_corners.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace kinecal::detail {

void check_unseen(const std::string& camera, std::span<const Sample> samples,
                  Diagnostics& diagnostics) {
  for (const double mark : {-1.0, 0.0}) {
    const std::ptrdiff_t fewest = mark < 0.0 ? 1 : 2;
    std::ptrdiff_t count = 0;
    std::string first;
    for (const Sample& sample : samples) {
      const Observation* seen = sample.observation(camera);
      if (seen == nullptr) continue;
      const auto here =
          std::count_if(seen->features.begin(), seen->features.end(), [&](const Feature& feature) {
            return feature.point.x() == mark && feature.point.y() == mark;
          });
      if (here < fewest) continue;
      if (count == 0) first = sample.source;
      count += here;
    }
    if (count == 0) continue;
    diagnostics.errors.push_back(fmt::format(
        "{}: {} of sensor '{}' {} at ({}, {}), {}the first here; leave out corners that were not "
        "seen",
        first, count == 1 ? "a feature" : fmt::format("{} features", count), camera,
        count == 1 ? "is" : "are", mark, mark, mark < 0.0 ? "outside its image, " : ""));
    return;
  }
}

}  // namespace kinecal::detail
