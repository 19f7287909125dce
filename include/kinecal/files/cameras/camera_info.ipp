// Definitions of camera_info.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"

namespace kinecal {

namespace detail {

[[nodiscard]] inline std::string matrix_to_yaml(std::string_view name, std::size_t rows,
                                                std::span<const double> row_major) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows,
                     row_major.size() / rows, numbers_to_yaml(row_major));
}

}  // namespace detail

KINECAL_INLINE bool is_blank(const CameraInfo& camera) {
  const auto zero = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
  };
  return camera.width == 0 && camera.height == 0 && camera.distortion_model.empty() &&
         zero(camera.d) && zero(camera.k) && zero(camera.r) && zero(camera.p);
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

KINECAL_INLINE std::string to_camera_info_yaml(const CameraInfo& camera,
                                               const std::string& camera_name) {
  std::string text = fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n",
                                 camera.width, camera.height, detail::name_to_yaml(camera_name));
  text += detail::matrix_to_yaml("camera_matrix", 3, camera.k);
  text += fmt::format("distortion_model: {}\n", detail::name_to_yaml(camera.distortion_model));
  text += detail::matrix_to_yaml("distortion_coefficients", 1, camera.d);
  text += detail::matrix_to_yaml("rectification_matrix", 3, camera.r);
  return text + detail::matrix_to_yaml("projection_matrix", 3, camera.p);
}

KINECAL_INLINE std::string to_camera_message_yaml(const CameraInfo& camera) {
  return fmt::format("height: {}\nwidth: {}\ndistortion_model: {}\nd: {}\nk: {}\nr: {}\np: {}\n",
                     camera.height, camera.width, detail::name_to_yaml(camera.distortion_model),
                     detail::numbers_to_yaml(camera.d), detail::numbers_to_yaml(camera.k),
                     detail::numbers_to_yaml(camera.r), detail::numbers_to_yaml(camera.p));
}

}  // namespace kinecal
