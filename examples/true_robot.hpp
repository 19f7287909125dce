// The true robot (study/true_robot.hpp) and the true camera of a simulation; they differ from URDF
// and driver.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>

#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/study/true_robot.hpp"
#include "simulation.hpp"

namespace kinecal::examples {

using kinecal::Positions;
using kinecal::sample_at;
using kinecal::true_pose;
using kinecal::TrueRobot;

/// A depth camera whose driver uses example_camera_info().
class TrueCamera {
 public:
  /// @param truth  has its errors: camera_fx, ..., camera_z_scaling
  /// @param frame  its optical frame
  TrueCamera(const ParameterTable& truth, std::string frame)
      : driver_(intrinsics_of(example_camera_info())), frame_(std::move(frame)) {
    for (std::size_t i = 0; i < errors_.size(); ++i) {
      errors_[i] = truth[parameter_name("camera", DepthCamera::kParameters[i].name)].value;
    }
  }

  /// The point that the driver reports.
  /// @param p_camera  (3) metres, in the optical frame
  [[nodiscard]] Feature record(const Vector3<double>& p_camera, SeededRandom& random) const {
    return {frame_, recorded_point(driver_, p_camera, errors_, {}, random)};
  }

  [[nodiscard]] const Intrinsics& driver() const { return driver_; }

 private:
  Intrinsics driver_;
  std::string frame_;
  std::array<double, 6> errors_{};
};

}  // namespace kinecal::examples
