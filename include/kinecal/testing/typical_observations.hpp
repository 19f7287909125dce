// Synthetic observations, for checking sensors without samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kinecal/sensors/lenses/lens_names.hpp"
#include "kinecal/sensors/sensor.hpp"
#include "kinecal/testing/random_input.hpp"

namespace kinecal::detail {

/// A lens's distortion_model and small coefficients; plumb_bob of a sensor without a lens, and of those that
/// contain it.
template <class M>
[[nodiscard]] std::pair<std::string, std::vector<double>> typical_distortion() {
  if constexpr (requires {
                  M::kLens;
                  M::kCoefficients;
                }) {
    if (!bends_pinhole(M::kLens)) {
      std::vector<double> d(M::kCoefficients);
      for (std::size_t i = 0; i < d.size(); ++i) d[i] = 0.02 / static_cast<double>(i + 1);
      return {std::string(M::kLens), d};
    }
  }
  return {"plumb_bob", {-0.2, 0.1, 1e-3, -2e-3, 0.0}};
}

/// Two synthetic observations of a sensor: see check_sensor().
template <class M>
[[nodiscard]] std::vector<Observation> typical_observations() {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  const auto [model, coefficients] = typical_distortion<M>();
  camera.distortion_model = model;
  camera.k = {525, 0, 319.5, 0, 530, 239.5, 0, 0, 1};
  camera.p = {520, 0, 318.0, 0, 0, 526, 241.0, 0, 0, 0, 1, 0};
  camera.z_offset = 0.01;
  camera.z_scaling = 1.02;
  RandomInput random;
  std::vector<Observation> all;
  for (const std::vector<double>& distortion : {std::vector<double>{}, coefficients}) {
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
