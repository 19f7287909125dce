// Camera intrinsics before and after a calibration: CameraInfo with relative changes applied, and
// the camera_info file that ROS drivers load.
//
//   f = f0 (1 + v)      c = c0 (1 + v)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "kinecal/io/yaml/yaml_text.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// True for the message that ROS sends for a sensor that is no camera: size and matrices are zero.
[[nodiscard]] inline bool is_blank(const CameraInfo& camera) {
  const auto zero = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
  };
  return camera.width == 0 && camera.height == 0 && camera.distortion_model.empty() &&
         zero(camera.d) && zero(camera.k) && zero(camera.r) && zero(camera.p);
}

/// The intrinsics that a calibration found.
///
/// K and P change alike: P is what points are projected with, K is what the image is rectified
/// with, and both hold the same lens.  P also holds -fx·Bx and -fy·By of a camera that stands at
/// (Bx, By) metres of the frame its points are in (the second one of a stereo pair); they are
/// scaled with the focal lengths, because a change of the lens does not move the camera.
/// @param camera          as it was while recording
/// @param fx, fy, cx, cy  relative changes, 0 for none
[[nodiscard]] inline CameraInfo calibrated_camera_info(const CameraInfo& camera, double fx,
                                                       double fy, double cx, double cy) {
  CameraInfo calibrated = camera;
  auto& k = calibrated.k;
  k[0] *= 1.0 + fx;
  k[2] *= 1.0 + cx;
  k[4] *= 1.0 + fy;
  k[5] *= 1.0 + cy;
  auto& p = calibrated.p;
  p[0] *= 1.0 + fx;
  p[2] *= 1.0 + cx;
  p[3] *= 1.0 + fx;
  p[5] *= 1.0 + fy;
  p[6] *= 1.0 + cy;
  p[7] *= 1.0 + fy;
  return calibrated;
}

namespace detail {

/// "[1.0, 2.0]"
template <class Numbers>
[[nodiscard]] std::string numbers_to_yaml(const Numbers& numbers) {
  std::string text = "[";
  for (const double number : numbers) {
    if (text.size() > 1) text += ", ";
    text += number_to_yaml(number);
  }
  return text + "]";
}

template <class Numbers>
[[nodiscard]] std::string matrix_to_yaml(std::string_view name, std::size_t rows,
                                         const Numbers& row_major) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows,
                     row_major.size() / rows, numbers_to_yaml(row_major));
}

}  // namespace detail

/// The camera_info file of a camera, every number with full precision.
/// @param camera_name  as the driver calls the camera
[[nodiscard]] inline std::string to_camera_info_yaml(const CameraInfo& camera,
                                                     const std::string& camera_name) {
  std::string text = fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n",
                                 camera.width, camera.height, name_to_yaml(camera_name));
  text += detail::matrix_to_yaml("camera_matrix", 3, camera.k);
  text += fmt::format("distortion_model: {}\n", name_to_yaml(camera.distortion_model));
  text += detail::matrix_to_yaml("distortion_coefficients", 1, camera.d);
  text += detail::matrix_to_yaml("rectification_matrix", 3, camera.r);
  return text + detail::matrix_to_yaml("projection_matrix", 3, camera.p);
}

/// The same as ROS 2 prints the message: sensor_msgs/CameraInfo without its header.
[[nodiscard]] inline std::string to_camera_message_yaml(const CameraInfo& camera) {
  return fmt::format("height: {}\nwidth: {}\ndistortion_model: {}\nd: {}\nk: {}\nr: {}\np: {}\n",
                     camera.height, camera.width, name_to_yaml(camera.distortion_model),
                     detail::numbers_to_yaml(camera.d), detail::numbers_to_yaml(camera.k),
                     detail::numbers_to_yaml(camera.r), detail::numbers_to_yaml(camera.p));
}

}  // namespace kinecal
