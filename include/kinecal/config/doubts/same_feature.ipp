// Finds the same feature in another observation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// The feature of an observation with the same id or, without ids, the same place; nullptr if
/// absent.
[[nodiscard]] inline const Feature* same_feature(const Observation& in, const Feature& feature,
                                                 std::size_t place) {
  if (!feature.id) return place < in.features.size() ? &in.features[place] : nullptr;
  const auto found = std::find_if(in.features.begin(), in.features.end(),
                                  [&](const Feature& other) { return other.id == feature.id; });
  return found != in.features.end() ? &*found : nullptr;
}

}  // namespace kinecal::detail
