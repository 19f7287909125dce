// Calibrations of cameras alone: configurations, and what the program does with them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/cameras/prepare_cameras.hpp"
#include "kinecal/config/own_frames.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::test {

/// A configuration of cameras that see a board with a pose of its own in each sample.
/// @param lens    of each camera
/// @param bent    the board may be bent
inline std::string cameras_config(const std::vector<std::string>& cameras, const std::string& lens,
                                  const std::string& coefficients, bool bent = false) {
  std::string models = std::string(" - {name: board, type: ") + (bent ? "board" : "chain3d") +
                       ", frame: board}\n",
              free, frames, blocks;
  for (const std::string& camera : cameras) {
    models += " - {name: " + camera + ", type: camera2d, frame: " + camera +
              (lens.empty() ? "" : ", lens: " + lens) + "}\n";
    std::istringstream names("fx fy cx cy " + coefficients);
    for (std::string name; names >> name;) free += (free.empty() ? "" : ", ") + camera + "_" + name;
    blocks += " - {name: " + camera +
              "_corners, type: chain3d_to_camera2d, model_3d: board, model_2d: " + camera + "}\n";
    if (camera != cameras.front()) {
      frames += " - {name: " + camera +
                "_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\n";
    }
  }
  if (bent) free += ", board_bend_x, board_bend_y";
  return "base_link: " + cameras.front() + "\nper_sample: [board]\nmodels:\n" + models +
         "free_params: [" + free + "]\n" + (frames.empty() ? "" : "free_frames:\n" + frames) +
         "error_blocks:\n" + blocks;
}

/// A calibration of cameras as the program makes it.
struct Cameras {
  Cameras(const std::string& text, std::vector<Sample> recorded) : samples(std::move(recorded)) {
    config = parse_config(text, "cameras.yaml", diagnostics);
    if (!diagnostics.errors.empty()) return;
    robot = parse_urdf(urdf_of_cameras(config), "cameras.urdf");
    (void)prepare_cameras(robot, config, samples, diagnostics);
    if (!diagnostics.errors.empty()) return;
    calibration = assemble(config, robot, samples, diagnostics);
    if (diagnostics.errors.empty()) result = calibrate(calibration);
  }
  [[nodiscard]] double cost() const { return result.steps.back().final_cost; }
  [[nodiscard]] double value(const std::string& name) const {
    return result.table[result.table.find(name)].value;
  }
  /// The camera_info that comes out.
  [[nodiscard]] CameraInfo info(const std::string& camera) const {
    const Eigen::VectorXd values = result.table.values();
    for (const MountedSensor& sensor : calibration.steps.back().problem->sensors()) {
      if (sensor.mount().name != camera) continue;
      const auto seen = std::find_if(samples.begin(), samples.end(), [&](const Sample& sample) {
        return sample.observation(camera) != nullptr;
      });
      return sensor.sensor().calibrated(
          *seen->observation(camera)->camera,
          sensor.own_values({values.data(), static_cast<std::size_t>(values.size())}));
    }
    return {};
  }

  Diagnostics diagnostics;
  Config config;
  Robot robot;
  std::vector<Sample> samples;
  Calibration calibration;
  CalibrationResult result;
};

}  // namespace kinecal::test
