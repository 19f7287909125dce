// Definitions of sensor_state.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/views/sensor_state.hpp"

namespace kinecal::detail {

KINECAL_INLINE SensorState::SensorState(const MountedSensor& sensor, const FreeSet& free,
                                        bool is_placed)
    : corrections(sensor.chains().size()), own(sensor.parameters(), free), placed(is_placed) {
  for (const SampledChain& chain : sensor.chains()) {
    columns.push_back(columns_of(chain.parameters(), free));
    twist_columns.push_back(kinecal::twist_columns(chain.chain(), columns.back()));
    effects.push_back(most_effects(chain.parameters()));
  }
}

KINECAL_INLINE void SensorState::set(const MountedSensor& sensor, ParameterValues values) {
  for (std::size_t c = 0; c < corrections.size(); ++c) {
    set_corrections(sensor.chains()[c].parameters(), values, corrections[c]);
  }
  own.set(sensor.parameters(), values);
}

}  // namespace kinecal::detail
