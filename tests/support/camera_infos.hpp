// Cameras as drivers describe them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/samples/sample.hpp"

namespace kinecal::test {

/// A camera of 640 x 480 pixels without distortion.
/// @param fx, fy  focal lengths, pixels
inline CameraInfo camera_info(double fx = 550.0, double fy = 545.0) {
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {0.0, 0.0, 0.0, 0.0, 0.0};
  info.k = {fx, 0, 320, 0, fy, 240, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {fx, 0, 320, 0, 0, fy, 240, 0, 0, 0, 1, 0};
  return info;
}

inline CameraInfo right_camera_of_a_stereo_pair() {
  CameraInfo camera = camera_info();
  camera.d = {0.1, -0.2, 0.001, 1.0 / 3.0, 0.0};
  camera.k = {554.2546911911879, 0.0, 320.5, 0.0, 554.5, 240.5, 0.0, 0.0, 1.0};
  camera.p = {550.0, 0.0, 321.0, -33.0, 0.0, 551.0, 241.0, 5.51, 0.0, 0.0, 1.0, 0.0};
  return camera;
}

}  // namespace kinecal::test
