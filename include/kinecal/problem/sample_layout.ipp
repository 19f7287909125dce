// Definitions of sample_layout.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/problem/sample_layout.hpp"

namespace kinecal::detail {

KINECAL_INLINE std::size_t SampleRow::append(const std::vector<double>& more) {
  const std::size_t first = layout.size;
  numbers.insert(numbers.end(), more.begin(), more.end());
  layout.size = numbers.size();
  return first;
}

KINECAL_INLINE void SampleRow::add_sensor(const ObservationNumbers* seen) {
  auto& of_sensor = layout.sensors.emplace_back();
  if (seen == nullptr) return;
  ObservationLayout& place = of_sensor.emplace();
  place.chain = seen->chain;
  for (const auto& joints : seen->joints) {
    place.joints.push_back(joints ? append(*joints) : kAbsent);
  }
  place.settings = append(seen->settings);
  place.measured = append(seen->measured);
  place.width = seen->measured.size() / seen->chain.size();
  const bool misses_some =
      std::find(seen->usable.begin(), seen->usable.end(), 0.0) != seen->usable.end();
  place.usable_step = misses_some ? 1 : 0;
  place.usable = append(misses_some ? seen->usable : std::vector{1.0});
}

KINECAL_INLINE void SampleRow::add_term(int term, const std::vector<double>& inverse_sigmas,
                                        const std::vector<double>& conditions, std::size_t step) {
  const std::size_t of_features = inverse_sigmas.empty() ? kAbsent : append(inverse_sigmas);
  layout.terms.push_back({term, of_features, append(conditions), step});
}

}  // namespace kinecal::detail
