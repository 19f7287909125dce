// A sample: one pose of the robot with what its sensors saw there.
//
// The same content as robot_calibration_msgs/CalibrationData, in metres, radians and pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// One observed point: metres in `frame`; a pixel is (u, v, 0).
struct Feature {
  std::string frame;
  Vector3<double> point = Vector3<double>::Zero();
};

/// What a camera was set to while it recorded (sensor_msgs/CameraInfo and its driver).
struct CameraInfo {
  int width = 0, height = 0;  ///< pixels
  std::string distortion_model;
  std::vector<double> d;       ///< k1 k2 p1 p2 k3 of plumb_bob
  std::array<double, 9> k{};   ///< 3x3, row-major, pixels
  std::array<double, 9> r{};   ///< 3x3, row-major
  std::array<double, 12> p{};  ///< 3x4, row-major, pixels
  double z_offset = 0.0;       ///< of the depth driver, metres (z_offset_mm in files)
  double z_scaling = 1.0;      ///< of the depth driver: z = (z0 + z_offset) * z_scaling
};

struct Observation {
  std::string sensor;
  std::vector<Feature> features;
  std::optional<CameraInfo> camera = {};
};

struct Sample {
  std::vector<std::string> joint_names;
  std::vector<double> joint_positions;  ///< radians or metres, in the order of the names
  std::vector<Observation> observations;
  std::string source;  ///< where it came from, for messages: "samples.yaml:37"

  [[nodiscard]] std::optional<double> position(const std::string& joint) const {
    for (std::size_t i = 0; i < joint_names.size(); ++i) {
      if (joint_names[i] == joint) return joint_positions[i];
    }
    return std::nullopt;
  }

  [[nodiscard]] const Observation* observation(const std::string& sensor) const {
    for (const Observation& o : observations) {
      if (o.sensor == sensor) return &o;
    }
    return nullptr;
  }
};

}  // namespace kinecal
