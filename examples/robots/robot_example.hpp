// A robot's crate for simulation and program: names and functions instead of types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "simulated.hpp"

namespace kinecal::examples {

struct ExampleSensor {
  Mount mount;
  std::string_view type;              ///< of the sensor, as in configurations
  std::optional<Target> target = {};  ///< if the crate names one
  std::optional<Measuring> measuring = {};
  bool moves = false;  ///< true if a joint of its chain moves
};

/// A plane in the base: points p with normal . p + distance = 0.
struct ExamplePlane {
  Vector3<double> normal;
  double distance = 0.0;
};

struct ExampleBlock {
  std::string name;
  std::vector<std::string> sensors = {};
  std::optional<ExamplePlane> plane = {};  ///< that its sensor sees, if it has only one sensor
};

/// One number that is free: of a joint, a frame or a camera.
struct ExampleParameter {
  std::string name, owner, part;
};

struct RobotExample {
  std::string urdf;  ///< path
  Robot robot;
  std::string base;
  std::vector<ExampleSensor> sensors = {};
  std::vector<ExampleBlock> blocks = {};
  std::vector<ExampleParameter> free = {};
  std::set<std::string> frames = {};  ///< the free ones
  std::string virtual_frame = {};     ///< of the targets; empty: targets are at the tips
  /// The crate's problem, without samples; cameras start from the settings in these samples.
  std::function<std::unique_ptr<AnyProblem>(std::span<const Sample>)> problem = {};
  std::function<FreeSet(const ParameterTable&)> free_set = {};
  /// Calibrates and judges the crate.
  std::function<CalibratedRobot(std::span<const Sample>, const std::string& urdf_text)> calibrate =
      {};
};

/// Calibrates a robot on simulated samples, or on those of a file, and prints the result.
/// @returns  0 if it converged and is as accurate as the noise allows, 1 on bad input, 2 otherwise
int calibrate_robot(const RobotExample& example, int argc, char** argv);

}  // namespace kinecal::examples
