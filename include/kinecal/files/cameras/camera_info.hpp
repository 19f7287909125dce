// The files of a camera that others load: camera_info of ROS drivers, Kalibr's, OpenCV's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// True for an all-zero message, which ROS sends for a sensor that is not a camera.
[[nodiscard]] bool is_blank(const CameraInfo& camera);

/// The camera_info file of a camera, all numbers with full precision.
/// @param camera_name  the driver's name of the camera
[[nodiscard]] std::string to_camera_info_yaml(const CameraInfo& camera,
                                              const std::string& camera_name);

/// The same in the format of a ROS 2 message: sensor_msgs/CameraInfo without its header.
[[nodiscard]] std::string to_camera_message_yaml(const CameraInfo& camera);

/// A camera of Kalibr's camchain.
/// @throws std::invalid_argument  if Kalibr has no lens with these coefficients
[[nodiscard]] std::string to_kalibr_yaml(const CameraInfo& camera, const std::string& camera_name);

/// The file of OpenCV's FileStorage, of the raw image.
/// @throws std::invalid_argument  if OpenCV has no lens with these coefficients
[[nodiscard]] std::string to_opencv_yaml(const CameraInfo& camera);

}  // namespace kinecal
