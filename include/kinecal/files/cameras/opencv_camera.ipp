// Cameras in files of OpenCV's FileStorage.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/cameras/camera_formats.ipp"
#include "kinecal/files/cameras/distortion_keys.ipp"
#include "kinecal/files/cameras/image_part.ipp"

namespace kinecal::detail {

/// The text without OpenCV's first line %YAML:1.0, which is not YAML; keeps line numbers.
[[nodiscard]] inline std::string without_opencv_header(std::string text) {
  const std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  const std::string_view line = std::string_view(text).substr(begin);
  if (!line.starts_with("%YAML:") && !line.starts_with("%YAML 1.0")) return text;
  const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
  return text.replace(begin, end - begin, "");
}

[[nodiscard]] inline bool is_opencv_matrix(const ConfigEntry& entry) {
  return entry.value.is_map() && entry.value.tag.ends_with("opencv-matrix");
}

/// All keys of a file that equal a wanted one except for case and underscores.
[[nodiscard]] inline CameraKeys opencv_keys(const ConfigMap& file, const CameraKeys& wanted) {
  CameraKeys keys;
  for (const std::string& key : wanted) {
    for (const ConfigEntry& entry : file.entries()) {
      if (plain_key(entry.key) == plain_key(key)) keys.push_back(entry.key);
    }
  }
  return keys;
}

/// All keys of a file that are well-known for a distortion and have numbers.
[[nodiscard]] inline CameraKeys opencv_distortion_keys(const ConfigMap& file) {
  CameraKeys keys;
  for (const ConfigEntry& entry : file.entries()) {
    const bool numbers = entry.value.is_map() || entry.value.is_list();
    if (numbers && is_distortion_key(entry.key)) keys.push_back(entry.key);
  }
  return keys;
}

/// Reads a file of OpenCV's FileStorage.
/// @param file  the top-level map
[[nodiscard]] inline CameraInfo read_opencv_camera(ConfigMap& file) {
  const auto keys = [&](const CameraKeys& wanted) { return opencv_keys(file, wanted); };
  CameraInfo camera;
  camera.width = read_camera_size(file, keys({"image_width"}));
  camera.height = read_camera_size(file, keys({"image_height"}));
  const ConfigEntry* fisheye = find_camera_key(file, keys({"fisheye_model"}));
  const bool is_fisheye = fisheye != nullptr && file.number(fisheye->key, 0.0) != 0.0;
  if (!read_camera_matrix(file, keys({"camera_matrix", "K"}), camera.k)) {
    file.error(file.place(), "camera_matrix is missing");
  }
  const ConfigEntry* d = find_camera_key(file, opencv_distortion_keys(file));
  if (d != nullptr) {
    camera.d = camera_numbers(file, *d).value_or(std::vector<double>());
  } else {
    doubt_no_distortion(file,
                        keys({"camera_matrix", "K", "rectification_matrix", "projection_matrix"}),
                        "distortion_coefficients", true);
  }
  const std::size_t n = camera.d.size();
  const bool is_known =
      is_fisheye ? n == 4 : n == 0 || n == 4 || n == 5 || n == 8 || n == 12 || n == 14;
  if (!is_known) {
    file.error(d != nullptr ? d->place : file.place(),
               has_numbers(d != nullptr ? d->key : "distortion_coefficients", n) +
                   (is_fisheye ? "; a fisheye_model has 4" : "; OpenCV has 4, 5, 8, 12 or 14"));
  }
  if (n < 5 && !is_fisheye) camera.d.resize(5, 0.0);
  camera.distortion_model = is_fisheye ? "equidistant"
                            : n >= 8   ? "rational_polynomial"
                                       : "plumb_bob";
  if (camera.width == 0 || camera.height == 0) {
    refuse_lost_size(file, "image_width and image_height");
  }
  const bool has_r = read_camera_matrix(file, keys({"rectification_matrix"}), camera.r);
  const bool has_p = read_camera_matrix(file, keys({"projection_matrix"}), camera.p);
  complete_camera(camera, has_r, has_p, file.place(), file.diagnostics());
  return camera;
}

}  // namespace kinecal::detail
