// Definitions of any_sensor.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/any_sensor.hpp"

namespace kinecal {

KINECAL_INLINE void add_sensor_parameters(ParameterTable& table, const AnySensor& sensor,
                                          const Mount& mount, std::span<const Sample> samples) {
  std::vector<double> settings;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(mount.name);
    if (seen == nullptr) continue;
    try {
      settings = sensor.settings(*seen);
      break;
    } catch (const SettingsError&) {  // adding the sample reports the reason
    }
  }
  const std::vector<double> initial = sensor.initial(settings);
  std::vector<ParameterInfo> infos(sensor.parameters().begin(), sensor.parameters().end());
  for (std::size_t i = 0; i < infos.size(); ++i) infos[i].initial = initial[i];
  add_parameters(table, mount.parameter_prefix(), infos);
}

}  // namespace kinecal
