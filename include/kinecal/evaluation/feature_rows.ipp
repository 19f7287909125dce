// Computed once for all scalars: the columns of sensors, and runs of features on the same chains.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/feature_rows.hpp"

namespace kinecal::detail {

KINECAL_INLINE SensorState::SensorState(const MountedSensor& sensor, const FreeSet& free,
                                        bool is_placed)
    : corrections(sensor.chains().size()), own(sensor.parameters(), free), placed(is_placed) {
  for (std::size_t c = 0; c < sensor.chains().size(); ++c) {
    columns.push_back(columns_of(sensor.chain_parameters()[c], free));
    twist_columns.push_back(kinecal::twist_columns(sensor.chains()[c], columns.back()));
    models.push_back(have_models(sensor.chain_parameters()[c]));
  }
}

KINECAL_INLINE void SensorState::set(const MountedSensor& sensor, std::span<const double> values) {
  for (std::size_t c = 0; c < corrections.size(); ++c) {
    set_corrections(sensor.chain_parameters()[c], values, corrections[c]);
  }
  own.set(sensor.parameters(), values);
}

KINECAL_INLINE std::vector<FeatureRun> feature_runs(const Term& term, const SampleLayout& layout,
                                                    std::span<const SensorState> sensors,
                                                    const OwnParameters& own) {
  std::vector<const std::vector<std::size_t>*> chains;
  for (const int s : term.sensors) {
    chains.push_back(&layout.sensors[static_cast<std::size_t>(s)]->chain);
  }
  std::vector<FeatureRun> runs;
  // A plane through all features counts as one.
  const std::size_t features = term.pairs_features() ? chains[0]->size() : 1;
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
