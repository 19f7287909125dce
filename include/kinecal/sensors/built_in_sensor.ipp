// Definitions of built_in_sensor.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kinecal/sensors/built_in_sensor.hpp"

namespace kinecal {

KINECAL_INLINE std::shared_ptr<const AnySensor> any_built_in(const BuiltInSensor& sensor) {
  return std::visit([](const auto& model) { return any_sensor(model); }, sensor);
}

KINECAL_INLINE BuiltInSensor lens_camera(std::string_view lens, ImageKind image) {
  std::optional<BuiltInSensor> camera;
  const auto add = [&]<class... Ls>(LensList<Ls...>) {
    ((lens == Ls::kName ? (void)camera.emplace(LensCamera<Ls>{image}) : (void)0), ...);
  };
  add(Lenses());
  if (camera) return *camera;
  throw std::invalid_argument("there is no lens '" + std::string(lens) + "'");
}

}  // namespace kinecal
