// Checks specific to cameras: features that are not pixels, intrinsics of another image, a driver
// that has stopped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/sensor_points.hpp"
#include "kinecal/config/doubts/unseen_corners.ipp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// The camera_info of the first sample with a size; nullptr if absent.
[[nodiscard]] inline const CameraInfo* sized_camera(const RecordedPoints& recorded,
                                                    std::span<const Sample> samples) {
  const Observation* seen = samples[recorded.samples.front()].observation(recorded.model.name);
  const bool sized = seen->camera && seen->camera->width > 0 && seen->camera->height > 0;
  return sized ? &*seen->camera : nullptr;
}

/// Doubt: pixels outside of the image.
/// @param pixels  (u, v, any) of each of the recorded points
/// @param few     fraction of them that may be outside
inline void check_inside(const RecordedPoints& recorded, std::span<const Vector3<double>> pixels,
                         const CameraInfo& camera, double few, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  const double width = camera.width, height = camera.height;
  std::size_t last = 0;  // sample already counted
  double all = 0.0;
  Occurrences outside;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double u = pixels[i].x(), v = pixels[i].y();
    const bool is_outside =
        u < -0.1 * width || u > 1.1 * width || v < -0.1 * height || v > 1.1 * height;
    all += is_outside ? 1.0 : 0.0;
    if (!is_outside || (outside.count > 0 && last == recorded.samples[i])) continue;
    last = recorded.samples[i];
    outside.add(last);
  }
  if (all <= few * static_cast<double>(pixels.size())) return;
  diagnostics.doubt(place_of(samples, outside.first),
                    fmt::format("a feature of sensor '{}' is outside its image of {}x{} pixels{}; "
                                "is it the camera_info of another camera or size?",
                                recorded.model.name, width, height, outside.others()));
}

/// Error or doubt: features that are not pixels.
inline void check_pixels(const RecordedPoints& recorded, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  check_unseen(recorded.model.name, samples, diagnostics);
  const CameraInfo* camera = sized_camera(recorded, samples);
  if (camera == nullptr) return;
  double most = 0.0;
  for (const auto& pixel : recorded.points)
    most = std::max(most, pixel.head<2>().cwiseAbs().maxCoeff());
  if (most < 4.0 && recorded.points.size() > 3) {
    diagnostics.error(
        place_of(samples, recorded.samples.front()),
        fmt::format("no feature of sensor '{}' is beyond {:.3g} pixels of an image of "
                    "{}x{}; they look like metres or normalized coordinates",
                    recorded.model.name, most, camera->width, camera->height));
  } else {
    check_inside(recorded, recorded.points, *camera, 0.0, samples, diagnostics);
  }
}

/// Error or doubt: points of a depth camera that contradict its camera_info.
inline void check_depth_points(const RecordedPoints& recorded, std::span<const Sample> samples,
                               Diagnostics& diagnostics) {
  std::vector<Vector3<double>> pixels;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const std::size_t s = recorded.samples[i];
    const Observation& seen = *samples[s].observation(recorded.model.name);
    const std::shared_ptr<const AnySensor> sensor = sensor_of(recorded.model);
    pixels.push_back(sensor->measurement(recorded.points[i], sensor->settings(seen)));
    if (pixels.back().z() > 0.0) continue;
    diagnostics.error(
        place_of(samples, s),
        fmt::format(
            "sensor '{}' has a point {:.4g} m away, which its driver made of a depth of "
            "{:.4g} m by z_offset_mm {:.6g} and z_scaling {:.6g} of ext_camera_info; one of "
            "them is wrong",
            recorded.model.name, recorded.points[i].z(), pixels.back().z(),
            1e3 * seen.camera->z_offset, seen.camera->z_scaling));
    return;
  }
  const CameraInfo* camera = sized_camera(recorded, samples);
  constexpr double kFew = 0.05;  // a driver may give points beyond its image
  if (camera != nullptr) check_inside(recorded, pixels, *camera, kFew, samples, diagnostics);
}

/// Doubt: a principal point far from the middle of the image, as if from another resolution.
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

/// Error: a camera that records the same in every sample although the robot moves.
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
