// A robot's crate as the simulation and the program know it: names and functions, no types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/crate/problem.hpp"
#include "simulated.hpp"

namespace kinecal::examples {

struct ExampleSensor {
  Sensor sensor;
  std::optional<Target> target = {};  ///< that the crate names
  std::optional<Measuring> measuring = {};
  bool moves = false;  ///< some joint of its chain does
};

/// A plane in the base: points p with normal . p + distance = 0.
struct ExamplePlane {
  Vector3<double> normal;
  double distance = 0.0;
};

struct ExampleBlock {
  std::string name;
  std::vector<std::string> sensors = {};
  std::optional<ExamplePlane> plane = {};  ///< that its sensor sees, if it has but one
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
  std::set<std::string> frames = {};  ///< those that are free
  std::string virtual_frame = {};     ///< in which chains carry their targets; empty: at their tips
  /// The crate's problem, without samples; what its cameras start from is taken from these.
  std::function<Problem(std::span<const Sample>)> problem = {};
  std::function<FreeSet(const ParameterTable&)> free_set = {};
};

/// Calibrates a robot on simulated samples, or on those of a file, and prints what came of it.
/// @returns  0 if it converged and the robot is as well known as the noise allows, 1 on bad input,
///           2 otherwise
int calibrate_robot(const RobotExample& example, int argc, char** argv);

}  // namespace kinecal::examples
