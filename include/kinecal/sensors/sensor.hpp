// A sensor: it is fixed to a link, and the samples list its observations.
//
//   chain3d   points at known positions in its link: metres, in the link
//   camera3d  a depth camera: metres, in its optical frame                    (depth_camera.hpp)
//   camera2d  a pinhole camera: pixels                                        (pinhole_camera.hpp)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/sensors/depth_camera.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"

namespace kinecal {

/// Types of sensors, named as in configurations.
enum class SensorType {
  chain3d,   ///< points at known positions in a link
  camera3d,  ///< a depth camera
  camera2d   ///< a pinhole camera
};

/// The type's name in a configuration.
[[nodiscard]] constexpr std::string_view to_string(SensorType type) {
  constexpr std::string_view kNames[] = {"chain3d", "camera3d", "camera2d"};
  return kNames[static_cast<int>(type)];
}

/// Number of the sensor's own parameters: the first ones of kCameraParameters.
[[nodiscard]] constexpr int sensor_parameters(SensorType type) {
  if (type == SensorType::camera3d) return DepthCamera<>::kParameters;
  return type == SensorType::camera2d ? PinholeCamera<>::kParameters : 0;
}

/// A sensor of a calibration.
struct Sensor {
  std::string name;                       ///< as in the samples
  SensorType type = SensorType::chain3d;  ///< what it observes
  std::string frame;                      ///< the link to which it is fixed
  std::string param_name;                 ///< prefix of its parameters; empty: its name

  /// Prefix of its parameters: "camera" of "camera_fx".
  [[nodiscard]] const std::string& parameter_prefix() const {
    return param_name.empty() ? name : param_name;
  }
};

}  // namespace kinecal
