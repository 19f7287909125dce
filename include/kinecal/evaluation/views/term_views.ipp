// Definitions of term_views.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/views/term_views.hpp"

namespace kinecal::detail {

KINECAL_INLINE std::vector<FeatureRun> feature_runs(const Term& term, const SampleLayout& layout,
                                                    std::span<const SensorState> sensors,
                                                    const OwnParameters& own) {
  std::vector<const std::vector<std::size_t>*> chains;
  for (const int s : term.sensors) {
    chains.push_back(&layout.sensors[static_cast<std::size_t>(s)]->chain);
  }
  std::vector<FeatureRun> runs;
  // A plane through all features counts as one, and so does a residual without a sensor.
  const bool is_one = chains.empty() || !term.pairs_features();
  const std::size_t features = is_one ? 1 : chains[0]->size();
  for (std::size_t i = 0; i < features; ++i) {
    BodyChains of_feature{};
    for (std::size_t s = 0; s < chains.size(); ++s) of_feature[s] = (*chains[s])[i];
    if (runs.empty() || runs.back().chains != of_feature) runs.push_back({i, i, of_feature, {}});
    runs.back().end = i + 1;
  }
  for (FeatureRun& run : runs) {
    const auto append = [&run](const std::vector<int>& more) {
      run.columns.insert(run.columns.end(), more.begin(), more.end());
    };
    for (const int s : term.sensors) append(sensors[static_cast<std::size_t>(s)].own.columns);
    append(own.columns);
    for (const auto twists : {&TwistColumns::rotational, &TwistColumns::translational}) {
      for (std::size_t i = 0; i < chains.size(); ++i) {
        const SensorState& sensor = sensors[static_cast<std::size_t>(term.sensors[i])];
        append(sensor.twist_columns[run.chains[i]].*twists);
      }
    }
  }
  return runs;
}

}  // namespace kinecal::detail
