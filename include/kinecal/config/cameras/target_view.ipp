// What a camera sees of a flat target in a sample.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "kinecal/config/cameras/camera_start.hpp"
#include "kinecal/samples/paired_features.hpp"

namespace kinecal::detail {

/// The corners that both sensors have; empty for a target that is not flat.
/// @param target, camera  names of sensors
[[nodiscard]] inline TargetView target_view(const std::string& target, const std::string& camera,
                                            const Sample& given) {
  const ComparedSensors both{{target, camera}};
  const std::optional<Sample> paired =
      has_ids(given) ? pair_features(given, std::span(&both, 1)) : std::nullopt;
  const Sample& sample = paired ? *paired : given;
  const Observation *of_target = sample.observation(target),
                    *of_camera = sample.observation(camera);
  TargetView view;
  double height = 0.0;  // of the target's plane
  if (of_target == nullptr || of_camera == nullptr) return view;
  const std::size_t count = std::min(of_target->features.size(), of_camera->features.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3<double>&on = of_target->features[i].point, &seen = of_camera->features[i].point;
    if (!on.allFinite() || !seen.allFinite()) continue;
    constexpr double kFlat = 1e-6;  // metres
    if (view.plane.empty()) height = on.z();
    if (std::abs(on.z() - height) > kFlat) return {};
    view.plane.emplace_back(on.head<2>());
    view.pixels.emplace_back(seen.head<2>());
  }
  return view;
}

}  // namespace kinecal::detail
