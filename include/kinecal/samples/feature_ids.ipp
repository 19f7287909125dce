// The ids of an observation, and reordering of its features.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// The ids of an observation in the order of its features; empty if absent.
/// @throws SampleError  if some features lack an id, or two have the same
[[nodiscard]] inline std::vector<int> ids_of(const Observation& seen) {
  std::vector<int> ids;
  for (const Feature& feature : seen.features) {
    if (feature.id) ids.push_back(*feature.id);
  }
  const std::size_t missing = seen.features.size() - ids.size();
  if (ids.empty() || missing > 0) {
    if (ids.empty()) return ids;
    throw SampleError("sensor '" + seen.sensor + "': " + std::to_string(missing) + " of its " +
                      std::to_string(seen.features.size()) +
                      (missing == 1 ? " features has" : " features have") +
                      " no id; give all of them one, or none");
  }
  std::vector<int> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    throw SampleError("sensor '" + seen.sensor + "': two features have the id " +
                      std::to_string(*twice) + "; each feature needs an id of its own");
  }
  return ids;
}

/// The stand-in for a feature that a sensor did not see.
/// @param near  a feature that it saw, for the frame
[[nodiscard]] inline Feature unseen_feature(const Feature& near, int id) {
  Feature feature{near.frame};
  feature.point.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (near.rotation) feature.rotation = Matrix3<double>::Identity();
  feature.id = id;
  return feature;
}

/// The features of an observation in the order of some ids.
[[nodiscard]] inline std::vector<Feature> in_order(const std::vector<Feature>& features,
                                                   const std::vector<int>& order) {
  std::map<int, const Feature*> by_id;
  for (const Feature& feature : features) by_id.emplace(*feature.id, &feature);
  std::vector<Feature> ordered;
  ordered.reserve(order.size());
  const Feature* near = &features.front();
  for (const int id : order) {
    const auto found = by_id.find(id);
    if (found != by_id.end()) near = found->second;
    ordered.push_back(found != by_id.end() ? *near : unseen_feature(*near, id));
  }
  return ordered;
}

}  // namespace kinecal::detail
