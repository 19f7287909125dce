// A camera's own parameters and their initial values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// Adds the parameters of a sensor, if it is a camera.  Depth offset and scaling start from the
/// driver's settings when the samples were recorded.
inline void add_camera_parameters(ParameterTable& table, const Sensor& sensor,
                                  std::span<const Sample> samples) {
  double initial[6] = {};
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(sensor.name);
    if (seen == nullptr || !seen->camera) continue;
    initial[4] = seen->camera->z_offset;
    initial[5] = seen->camera->z_scaling - 1.0;
    break;
  }
  for (int i = 0; i < sensor_parameters(sensor.type); ++i) {
    const auto part = kCameraParameters[static_cast<std::size_t>(i)];
    const std::string name = parameter_name(sensor.parameter_prefix(), part);
    if (table.find(name) >= 0) continue;
    table.add({.name = name,
               .unit = part == "z_offset" ? "m" : "1",
               .initial = initial[i],
               .value = initial[i]});
  }
}

}  // namespace kinecal
