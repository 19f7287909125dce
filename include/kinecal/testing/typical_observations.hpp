// Synthetic observations, for checking sensors without samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/sensors/sensor.hpp"
#include "kinecal/testing/random_input.hpp"

namespace kinecal::detail {

/// Two synthetic observations of a sensor: see check_sensor().
template <Sensor M>
[[nodiscard]] std::vector<Observation> typical_observations() {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.distortion_model = "plumb_bob";
  camera.k = {525, 0, 319.5, 0, 530, 239.5, 0, 0, 1};
  camera.p = {520, 0, 318.0, 0, 0, 526, 241.0, 0, 0, 0, 1, 0};
  camera.z_offset = 0.01;
  camera.z_scaling = 1.02;
  RandomInput random;
  std::vector<Observation> all;
  for (const std::vector<double>& distortion :
       {std::vector<double>{}, std::vector<double>{-0.2, 0.1, 1e-3, -2e-3, 0.0}}) {
    camera.d = distortion;
    Observation& seen = all.emplace_back(Observation{"sensor", {}, camera});
    for (int i = 0; i < 16; ++i) {
      const double z = random(0.5, 2.0);
      Feature feature{"frame", {random(-0.4, 0.4) * z, random(-0.4, 0.4) * z, z}};
      if constexpr (kIsOriented<M>) feature.rotation = random.pose().rotation;
      if constexpr (PlacesOne<M, Quantity::reading>) feature.point = {z, 0.0, 0.0};
      if constexpr (PlacesOne<M, Quantity::ray>) {
        feature.point = {random(100, 540), random(80, 400), 0.0};
      }
      seen.features.push_back(feature);
    }
  }
  return all;
}

}  // namespace kinecal::detail
