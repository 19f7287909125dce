// A sensor: something on the robot whose observations are listed in the samples.
//
//   chain3d   observes points at known places of its link: metres, in the link
//   camera3d  a depth camera: metres, in its optical frame                    (depth_camera.hpp)
//   camera2d  a pinhole camera: pixels                                        (pinhole_camera.hpp)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/sensors/depth_camera.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"

namespace kinecal {

enum class SensorType { chain3d, camera3d, camera2d };

[[nodiscard]] constexpr std::string_view to_string(SensorType type) {
  constexpr std::string_view kNames[] = {"chain3d", "camera3d", "camera2d"};
  return kNames[static_cast<int>(type)];
}

/// Number of parameters of the sensor itself: the first so many of kCameraParameters.
[[nodiscard]] constexpr int sensor_parameters(SensorType type) {
  if (type == SensorType::camera3d) return DepthCamera<>::kParameters;
  return type == SensorType::camera2d ? PinholeCamera<>::kParameters : 0;
}

struct Sensor {
  std::string name;
  SensorType type = SensorType::chain3d;
  std::string frame;       ///< the link it is fixed to
  std::string param_name;  ///< prefix of its parameters; empty: its name

  [[nodiscard]] const std::string& parameter_prefix() const {
    return param_name.empty() ? name : param_name;
  }
};

}  // namespace kinecal
