// camera_info files, as ROS drivers load them, and the message as it is printed.
//
//   file      image_width, image_height, camera_name, distortion_model; camera_matrix,
//             distortion_coefficients, rectification_matrix, projection_matrix {rows, cols, data}
//   message   width, height, distortion_model; K D R P (ROS 1) or k d r p (ROS 2), lists
//
// Source: ROS wiki, camera_calibration_parsers; sensor_msgs/CameraInfo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/io/cameras/camera_fields.hpp"

namespace kinecal {

/// @param file  the top-level map
[[nodiscard]] inline CameraInfo read_camera_info(ConfigMap& file) {
  using namespace detail;
  CameraInfo camera;
  camera.width = read_camera_size(file, {"image_width", "width"});
  camera.height = read_camera_size(file, {"image_height", "height"});
  const ConfigEntry* model = file.find("distortion_model");
  const bool is_empty =
      model != nullptr && model->value.IsScalar() && model->value.Scalar().empty();
  if (!is_empty) camera.distortion_model = file.text("distortion_model").value_or("plumb_bob");
  if (const ConfigEntry* d = find_camera_key(file, {"distortion_coefficients", "D", "d"})) {
    camera.d = camera_numbers(file, *d).value_or(std::vector<double>());
  }
  if (!read_camera_matrix(file, {"camera_matrix", "K", "k"}, camera.k)) {
    file.error(file.place(), "camera_matrix is missing");
  }
  const bool has_r = read_camera_matrix(file, {"rectification_matrix", "R", "r"}, camera.r);
  const bool has_p = read_camera_matrix(file, {"projection_matrix", "P", "p"}, camera.p);
  file.ignore({"camera_name", "header", "binning_x", "binning_y", "roi"});
  file.report_unknown();  // a misspelt projection_matrix must not become camera_matrix
  complete_camera(camera, has_r, has_p, file.place(), file.diagnostics());
  return camera;
}

}  // namespace kinecal
