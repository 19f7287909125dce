// Camera intrinsics before and after a calibration: CameraInfo with relative changes applied, and
// the camera_info file that ROS drivers load.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/linkage.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"

namespace kinecal {

/// True for the message that ROS sends for a sensor that is not a camera: all of it is zero.
[[nodiscard]] bool is_blank(const CameraInfo& camera);

/// The intrinsics that a calibration found.  f = f0 (1 + v)  c = c0 (1 + v)
///
/// K and P change alike: points are projected with P, images are rectified with K, and both
/// describe the same lens.  P also contains -fx·Bx and -fy·By of a camera that stands at (Bx, By),
/// metres, in the frame of its points (the second one of a stereo pair).  These are scaled with the
/// focal lengths, because a change of the lens does not move the camera.
///
/// Where it is known what the image was of, its matrix (K of a raw one, P of a rectified one) gets
/// exactly these values, and the other follows so that P K^-1 stays: drivers that rectify with the
/// new K to the new P show the same image as before.  A matrix of zeros stays one.
/// @param camera          as recorded
/// @param fx, fy, cx, cy  relative changes, 0 for none
/// @param image           which matrix they are of; automatic: of both
[[nodiscard]] CameraInfo calibrated_camera_info(const CameraInfo& camera, double fx, double fy,
                                                double cx, double cy,
                                                ImageKind image = ImageKind::automatic);

/// The camera_info file of a camera, all numbers with full precision.
/// @param camera_name  the driver's name of the camera
[[nodiscard]] std::string to_camera_info_yaml(const CameraInfo& camera,
                                              const std::string& camera_name);

/// The same as ROS 2 prints the message: sensor_msgs/CameraInfo without its header.
[[nodiscard]] std::string to_camera_message_yaml(const CameraInfo& camera);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/cameras/camera_info.ipp"
#endif
