// What only cameras get wrong: pixels that are none, intrinsics of another image, a driver that has
// stopped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/doubts/occurrences.hpp"
#include "kinecal/io/doubts/sensor_points.hpp"

namespace kinecal::detail {

/// Error or doubt: pixels that are none.
inline void check_pixels(const RecordedPoints& recorded, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  const Observation* seen = samples[recorded.samples.front()].observation(recorded.model.name);
  if (!seen->camera || seen->camera->width <= 0 || seen->camera->height <= 0) return;
  const double width = seen->camera->width, height = seen->camera->height;
  double most = 0.0;
  std::size_t last = 0;  // sample that is counted
  Occurrences outside;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const double u = recorded.points[i].x(), v = recorded.points[i].y();
    most = std::max({most, std::abs(u), std::abs(v)});
    const bool is_outside =
        u < -0.1 * width || u > 1.1 * width || v < -0.1 * height || v > 1.1 * height;
    if (!is_outside || (outside.count > 0 && last == recorded.samples[i])) continue;
    last = recorded.samples[i];
    outside.add(last);
  }
  if (most < 4.0 && recorded.points.size() > 3) {
    diagnostics.error(
        place_of(samples, recorded.samples.front()),
        fmt::format("no feature of sensor '{}' is beyond {:.3g} pixels of an image of "
                    "{}x{}; they look like metres or normalized coordinates",
                    recorded.model.name, most, width, height));
  } else if (outside.count > 0) {
    diagnostics.doubt(
        place_of(samples, outside.first),
        fmt::format("a feature of sensor '{}' is outside its image of {}x{} pixels{}; "
                    "is it the camera_info of another camera or size?",
                    recorded.model.name, width, height, outside.others()));
  }
}

/// Doubt: a principal point far from the middle of the image, as of another resolution.
inline void check_principal_points(std::span<const Sample> samples, Diagnostics& diagnostics) {
  std::set<std::string> checked;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    for (const Observation& seen : samples[s].observations) {
      if (!seen.camera || !checked.insert(seen.sensor).second) continue;
      const CameraInfo& camera = *seen.camera;
      const auto is_far = [](double point, int size) {
        constexpr double kFar = 0.3;  // of the size of the image
        return size > 0 && std::abs(point / size - 0.5) > kFar;
      };
      const auto doubt = [&](const char* matrix, double cx, double cy) {
        if (!is_far(cx, camera.width) && !is_far(cy, camera.height)) return false;
        diagnostics.doubt(
            place_of(samples, s),
            fmt::format(
                "the principal point of sensor '{}' is ({:.4g}, {:.4g}) by {}, far from the "
                "middle of its image of {}x{} pixels; is it the camera_info of another "
                "resolution?",
                seen.sensor, cx, cy, matrix, camera.width, camera.height));
        return true;
      };
      if (camera.k[0] > 0.0 && doubt("K", camera.k[2], camera.k[5])) continue;
      if (camera.p[0] > 0.0) doubt("P", camera.p[2], camera.p[6]);
    }
  }
}

/// Error: a camera that records the same in every sample though the robot moves.
inline void check_frozen(const RecordedPoints& recorded, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  const auto last = recorded.samples.back();
  if (!recorded.is_measured || !recorded.is_constant || recorded.samples.front() == last) return;
  if (samples[last].joint_positions == samples[recorded.samples.front()].joint_positions) return;
  diagnostics.error(
      place_of(samples, recorded.samples.front()),
      fmt::format("sensor '{}' records the same features, to the last digit, in every "
                  "sample though the robot moves; its driver or topic has stopped",
                  recorded.model.name));
}

}  // namespace kinecal::detail
