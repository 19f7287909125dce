// Definitions of camera_image.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kinecal/sensors/camera_image.hpp"
#include "kinecal/sensors/lenses/lens_names.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

KINECAL_INLINE bool is_raw(const CameraInfo& info, ImageKind image, std::string_view own_lens) {
  if (image != ImageKind::automatic) return image == ImageKind::raw;
  const bool has_k = info.k[0] != 0.0 || info.k[4] != 0.0;
  const bool has_p = info.p[0] != 0.0 || info.p[5] != 0.0;
  const std::string_view lens = lens_named(info.distortion_model);
  const bool is_own = lens.empty() && !own_lens.empty() && info.distortion_model == own_lens;
  const bool bends = is_own || (!lens.empty() && !bends_pinhole(lens)) ||
                     std::any_of(info.d.begin(), info.d.end(), [](double d) { return d != 0.0; });
  return has_k && (bends || !has_p);
}

KINECAL_INLINE std::array<double, 4> intrinsics_of(const CameraInfo& info, bool raw) {
  if (raw) return {info.k[0], info.k[4], info.k[2], info.k[5]};
  return {info.p[0], info.p[5], info.p[2], info.p[6]};
}

KINECAL_INLINE const CameraInfo& camera_info_of(const Observation& seen) {
  if (seen.camera) return *seen.camera;
  throw SettingsError("it is a camera but has no camera_info");
}

KINECAL_INLINE void check_camera_settings(std::span<const double> settings) {
  for (const double number : settings) {
    if (!std::isfinite(number)) throw SettingsError("camera_info has a value that is not a number");
  }
  if (!(settings[0] > 0.0 && settings[1] > 0.0)) {
    throw SettingsError("the focal lengths in camera_info are not positive");
  }
}

KINECAL_INLINE CameraInfo calibrated_camera_info(const CameraInfo& camera, double fx, double fy,
                                                 double cx, double cy, ImageKind image) {
  CameraInfo calibrated = camera;
  auto& k = calibrated.k;
  auto& p = calibrated.p;
  // Shifts of a principal point, in pixels of the other matrix.
  const auto follow = [](double shift, double focal, double of_other) {
    return focal != 0.0 ? shift * of_other / focal : 0.0;
  };
  const bool raw = image == ImageKind::raw, rectified = image == ImageKind::rectified;
  const double kx = rectified ? follow(p[2] * cx, p[0], k[0]) : k[2] * cx;
  const double ky = rectified ? follow(p[6] * cy, p[5], k[4]) : k[5] * cy;
  const double px = raw ? follow(k[2] * cx, k[0], p[0]) : p[2] * cx;
  const double py = raw ? follow(k[5] * cy, k[4], p[5]) : p[6] * cy;
  k[0] *= 1.0 + fx;
  k[2] += kx;
  k[4] *= 1.0 + fy;
  k[5] += ky;
  p[0] *= 1.0 + fx;
  p[2] += px;
  p[3] *= 1.0 + fx;
  p[5] *= 1.0 + fy;
  p[6] += py;
  p[7] *= 1.0 + fy;
  return calibrated;
}

}  // namespace kinecal
