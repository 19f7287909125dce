// Samples of a robot that is not quite what its URDF says, for the error blocks of its crate.
//
// The true robot is drawn at random: joints 2 to 4 degrees off, frames 5 to 10 mm and 1 to 2
// degrees, focal lengths and centres 1 to 2 percent, depths 5 mm and 1 percent.  Then for each
// block, where its sensors could have seen what it compares:
//
//   a camera and a chain     the points of the target at the chain's tip, all of them in the image
//   a tracker and a chain    the same points, measured in the frame of the chain that does not move
//   a camera and a plane     a grid of pixels, as far as they show the plane
//
// A pose is drawn within the limits of the joints and then changed, a joint at a time, until the
// target is seen; from there it wanders about among the poses in which it is.  Nothing knows where
// the robot's own body is: arms may pass through it and in front of a camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../true_robot.hpp"
#include "robot_example.hpp"

namespace kinecal::examples {

class Simulation {
 public:
  Simulation(const RobotExample& example, std::uint64_t seed);

  /// @param pairs, planes  how many samples for each block of two sensors and of one
  /// @throws std::invalid_argument  naming a block that cannot be simulated
  /// @throws std::runtime_error     naming a block whose target is seen from nowhere
  [[nodiscard]] std::vector<Sample> samples(int pairs, int planes);

  /// What is wrong with the robot, by the names of the parameters.
  [[nodiscard]] const ParameterTable& truth() const { return truth_; }

  /// What a pixel of a camera covers at the points it has seen so far, on average.
  /// @returns  metres
  [[nodiscard]] double metres_a_pixel(const std::string& camera) const;

 private:
  using Violation = std::function<double(const Positions&)>;  ///< zero where all is seen

  /// What a block compares, by who does what.
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
  /// What the eye reports of points in its own frame.
  [[nodiscard]] Observation observe(const ExampleSensor& eye,
                                    const std::vector<Vector3<double>>& points);

  const RobotExample& example_;
  SeededRandom random_;
  ParameterTable truth_;
  TrueRobot robot_;
  std::vector<const Joint*> joints_;                      ///< that have a position of their own
  std::map<std::string, std::pair<double, int>> depths_;  ///< by camera: their sum and number
};

}  // namespace kinecal::examples
