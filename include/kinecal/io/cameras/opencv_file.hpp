// A camera as OpenCV's FileStorage writes it in YAML.
//
//   %YAML:1.0
//   image_width: 640
//   camera_matrix: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [...]}
//   distortion_coefficients: !!opencv-matrix {...}
//
// Programs write the keys as they like: Camera_Matrix and cameraMatrix are the same to us.
// Four coefficients are plumb_bob with k3 = 0, five plumb_bob, eight rational_polynomial.
// Source: OpenCV documentation, FileStorage; calib3d, distortion coefficients.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/cameras/camera_fields.hpp"

namespace kinecal {

/// The text without its first line %YAML:1.0, which is no YAML; lines keep their numbers.
[[nodiscard]] inline std::string without_opencv_header(std::string text) {
  const std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  if (!std::string_view(text).substr(begin).starts_with("%YAML:")) return text;
  const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
  return text.replace(begin, end - begin, "");
}

[[nodiscard]] inline bool is_opencv_matrix(const ConfigEntry& entry) {
  return entry.value.IsMap() && entry.value.Tag().ends_with("opencv-matrix");
}

namespace detail {

/// All keys of a file that are this one but for case and underscores.
[[nodiscard]] inline CameraKeys opencv_keys(const ConfigMap& file, const CameraKeys& wanted) {
  const auto letters = [](std::string key) {
    std::erase(key, '_');
    for (char& c : key) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return key;
  };
  CameraKeys keys;
  for (const std::string& key : wanted) {
    for (const ConfigEntry& entry : file.entries()) {
      if (letters(entry.key) == letters(key)) keys.push_back(entry.key);
    }
  }
  return keys;
}

}  // namespace detail

/// @param file  the top-level map
[[nodiscard]] inline CameraInfo read_opencv_camera(ConfigMap& file) {
  using namespace detail;
  const auto keys = [&](const CameraKeys& wanted) { return opencv_keys(file, wanted); };
  CameraInfo camera;
  camera.width = read_camera_size(file, keys({"image_width"}));
  camera.height = read_camera_size(file, keys({"image_height"}));
  if (const ConfigEntry* fisheye = find_camera_key(file, keys({"fisheye_model"}))) {
    if (file.number(fisheye->key, 0.0) != 0.0) {
      file.error(fisheye->place, "fisheye_model: a fisheye camera is not read; a pinhole one is");
    }
  }
  if (!read_camera_matrix(file, keys({"camera_matrix", "K"}), camera.k)) {
    file.error(file.place(), "camera_matrix is missing");
  }
  const ConfigEntry* d =
      find_camera_key(file, keys({"distortion_coefficients", "dist_coeffs", "D"}));
  if (d != nullptr) camera.d = camera_numbers(file, *d).value_or(std::vector<double>());
  const std::size_t n = camera.d.size();
  if (n != 0 && n != 4 && n != 5 && n != 8) {
    file.error(d->place,
               fmt::format("{} has {} numbers; 4, 5 and 8 have a model in camera_info", d->key, n));
  }
  if (n < 5) camera.d.resize(5, 0.0);
  camera.distortion_model = n == 8 ? "rational_polynomial" : "plumb_bob";
  const bool has_r = read_camera_matrix(file, keys({"rectification_matrix"}), camera.r);
  const bool has_p = read_camera_matrix(file, keys({"projection_matrix"}), camera.p);
  complete_camera(camera, has_r, has_p, file.place(), file.diagnostics());
  return camera;
}

}  // namespace kinecal
