// Kalibr's camchain: a map of cameras, cam0, cam1 and so on.
//
//   cam0:
//     camera_model: pinhole
//     intrinsics: [fu, fv, pu, pv]
//     distortion_model: radtan
//     distortion_coeffs: [k1, k2, p1, p2]
//     resolution: [width, height]
//
// radtan is plumb_bob with k3 = 0.  Other models are no pinhole cameras of ROS and are refused.
// Source: Kalibr wiki, YAML formats and supported models.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/io/cameras/camera_fields.hpp"

namespace kinecal {

/// True for the entry of a camera: a map that names its model.
[[nodiscard]] inline bool is_kalibr_camera(const ConfigEntry& entry) {
  return entry.value.IsMap() && entry.value["camera_model"];
}

namespace detail {

/// So many numbers; none, and an error, if they are missing or others.
[[nodiscard]] inline std::vector<double> kalibr_numbers(ConfigMap& camera, const std::string& key,
                                                        std::size_t count) {
  const ConfigEntry* entry = camera.find(key);
  if (entry == nullptr) {
    camera.error(camera.place(), key + " is missing");
    return std::vector<double>(count, 0.0);
  }
  auto numbers = camera_numbers(camera, *entry);
  if (!numbers) return std::vector<double>(count, 0.0);
  if (numbers->size() != count) {
    camera.error(entry->place,
                 fmt::format("{} has {} numbers, not {}", key, numbers->size(), count));
    numbers->resize(count);
  }
  return *numbers;
}

/// The only model that is read.
inline void expect_kalibr_model(ConfigMap& camera, const std::string& key,
                                const std::string& expected) {
  const auto model = camera.required_text(key);
  if (!model || *model == expected) return;
  camera.error(camera.find(key)->place, key + " '" + *model + "' is not read; " + expected + " is");
}

}  // namespace detail

/// @param camera  the map of one camera
[[nodiscard]] inline CameraInfo read_kalibr_camera(ConfigMap& camera) {
  using namespace detail;
  const std::size_t errors = camera.diagnostics().errors.size();
  expect_kalibr_model(camera, "camera_model", "pinhole");
  expect_kalibr_model(camera, "distortion_model", "radtan");
  CameraInfo info;
  if (camera.diagnostics().errors.size() > errors) return info;  // its numbers mean other things
  const std::vector<double> f = kalibr_numbers(camera, "intrinsics", 4);
  info.distortion_model = "plumb_bob";
  info.d = kalibr_numbers(camera, "distortion_coeffs", 4);
  info.d.push_back(0.0);
  info.k = {f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1};
  const std::vector<double> size = kalibr_numbers(camera, "resolution", 2);
  for (const double pixels : size) {
    if (pixels >= 0.0 && pixels <= 1e6 && pixels == std::floor(pixels)) continue;
    camera.error(camera.place(), fmt::format("resolution: {} is not a number of pixels", pixels));
    return info;
  }
  info.width = static_cast<int>(size[0]);
  info.height = static_cast<int>(size[1]);
  complete_camera(info, false, false, camera.place(), camera.diagnostics());
  return info;
}

}  // namespace kinecal
