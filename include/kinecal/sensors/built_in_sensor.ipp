// Definitions of built_in_sensor.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/built_in_sensor.hpp"

namespace kinecal {

KINECAL_INLINE std::shared_ptr<const AnySensor> any_built_in(const BuiltInSensor& sensor) {
  return std::visit([](const auto& model) { return any_sensor(model); }, sensor);
}

}  // namespace kinecal
