// Definitions of built_in_sensor.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/built_in_sensor.hpp"

namespace kinecal {

KINECAL_INLINE std::shared_ptr<const AnySensor> any_built_in(const BuiltInSensor& sensor) {
  return std::visit([](const auto& model) { return any_sensor(model); }, sensor);
}

KINECAL_INLINE BuiltInSensor lens_camera(std::string_view lens, ImageKind image) {
  if (lens == PlumbBob::kName) return LensCamera<PlumbBob>{image};
  if (lens == RationalPolynomial::kName) return LensCamera<RationalPolynomial>{image};
  if (lens == ThinPrism::kName) return LensCamera<ThinPrism>{image};
  if (lens == Equidistant::kName) return LensCamera<Equidistant>{image};
  if (lens == DoubleSphere::kName) return LensCamera<DoubleSphere>{image};
  throw std::invalid_argument("there is no lens '" + std::string(lens) + "'");
}

}  // namespace kinecal
