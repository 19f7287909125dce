// Simulates samples of a robot that differs from its URDF, for the error blocks of its crate.
//
// The true robot is random: joints are 2 to 4 degrees off, frames 5 to 10 mm and 1 to 2 degrees,
// focal lengths and principal points 1 to 2 percent, depths 5 mm and 1 percent.  Then for each
// block, in poses in which its sensors see what it compares:
//
//   a camera and a chain     the points of the target at the chain's tip, all of them in the image
//   a tracker and a chain    the same points, measured in the frame of the chain that does not move
//   a camera and a plane     a grid of pixels, those that show the plane
//
// Starting from a random pose within the joint limits, one joint at a time is changed until the eye
// sees the target; from there it continues among such poses.  The simulation does not know the
// robot's body: arms may pass through it, or in front of a camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../true_robot.hpp"
#include "robot_example.hpp"

namespace kinecal::examples {

class Simulation {
 public:
  Simulation(const RobotExample& example, std::uint64_t seed);

  /// @param pairs, planes  number of samples for each block of two sensors and of one sensor
  /// @throws std::invalid_argument  if it cannot simulate a block, with its name
  /// @throws std::runtime_error     if it does not find a pose that sees the target of a block
  [[nodiscard]] std::vector<Sample> samples(int pairs, int planes);

  /// Errors of the URDF, by parameter name.
  [[nodiscard]] const ParameterTable& truth() const { return truth_; }

  /// Mean size of a camera's pixel at the points that it has observed so far.
  /// @returns  metres
  [[nodiscard]] double metres_a_pixel(const std::string& camera) const;

 private:
  using Violation = std::function<double(const Positions&)>;  ///< zero if everything is visible

  /// The two roles in what a block compares.
  struct Scene {
    const ExampleSensor* eye = nullptr;      ///< a camera or a tracker
    const ExampleSensor* carrier = nullptr;  ///< of the target
    std::optional<ExamplePlane> plane;
  };

  [[nodiscard]] Scene scene_of(const ExampleBlock& block) const;
  [[nodiscard]] Sample sample_of(const ExampleBlock& block, const Scene& scene);
  [[nodiscard]] Positions find_pose(const Violation& violation);
  [[nodiscard]] Pose<double> tip(const ExampleSensor& sensor, const Positions& positions) const;
  [[nodiscard]] double target_violation(const Scene& scene, const Positions& positions) const;
  [[nodiscard]] double plane_violation(const Scene& scene, const Positions& positions) const;
  [[nodiscard]] std::vector<Vector3<double>> plane_points(const Scene& scene,
                                                          const Positions& positions) const;
  /// The points that the eye reports, for points in its own frame.
  [[nodiscard]] Observation observe(const ExampleSensor& eye,
                                    const std::vector<Vector3<double>>& points);

  const RobotExample& example_;
  SeededRandom random_;
  ParameterTable truth_;
  TrueRobot robot_;
  std::vector<const Joint*> joints_;                      ///< with a position of their own
  std::map<std::string, std::pair<double, int>> depths_;  ///< by camera: their sum and number
};

}  // namespace kinecal::examples
