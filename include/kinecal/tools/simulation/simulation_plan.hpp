// The plan of a simulation: from a robot's URDF, and a scene file that overrides defaults.
//
//   seed: 1
//   camera: {frame: head_optical_frame, name: camera, type: camera3d, image: rectified, blur: 0.6}
//   target: {type: leds, link: gripper_link, xyz: [0, 0, 0.05], rpy: [0, 0, 0]}
//   errors: {joint: 0.05, position: 0.01, rotation: 0.02, intrinsics: 0.01}
//   noise: {pixel: 0.3}             # of features in studies, which draw no pictures
//   poses: 30                       # a number, or a file
//
// Defaults follow from the URDF: the camera and the arm that `kinecal init` proposes, and a target
// at the arm's end, or beside the robot if the arm carries the camera.  Target robot is the robot's
// own surface.  The errors are in the parameters that a first configuration calibrates.
// `simulation_plan.cpp` lists all keys.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/capture/session/pose_generation.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/study/error_sizes.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/study/simulated_robot.hpp"
#include "kinecal/surface/robot_surface.hpp"

namespace kinecal {

/// The target of a simulated camera.
struct SimulatedTarget {
  std::string type = "checkerboard";  ///< leds, checkerboard, apriltag, aprilgrid, ground or robot
  std::string link = {};              ///< that carries it; empty: the arm's end, or the base
  bool has_pose = false;              ///< false: placed where the camera can see it
  Pose<double> pose = {};             ///< link_T_target, metres; of boards: their finder's
  int columns = 0;                    ///< inner corners of a checkerboard, or tags; 0: usual
  int rows = 0;                       ///< the same
  double size = 0.0;                  ///< side of a square or of a tag, metres
  std::vector<Vector3<double>> leds = {};  ///< metres, in the link; empty: four
};

/// A simulated robot, its surroundings, and the poses to capture.
struct SimulationPlan {
  SimulatedSetup setup;    ///< makes a SimulatedRobot
  SimulatedTarget target;  ///< in view of the camera
  /// Of target robot: the links that the camera can see; not what it looks out of.
  std::shared_ptr<const RobotSurface> surface = {};
  std::string target_frame = {};        ///< of its points in samples
  std::string camera_type = {};         ///< camera3d or camera2d
  std::string chain_sensor = {};        ///< the sensor that holds the target
  std::string config = {};              ///< text of a first configuration: `kinecal init`
  ErrorSizes errors = {};               ///< of the true robot
  MeasurementNoise noise = {};          ///< of measured features and joints, for studies
  ViewGoal goal = {};                   ///< requirements on a view
  int poses = 30;                       ///< number of poses
  std::vector<JointTarget> given = {};  ///< poses from a file, instead of generated ones
};

/// Reads a scene, or uses only defaults.
/// @param path         of the scene; empty: only defaults
/// @param target       leds, checkerboard, apriltag, aprilgrid, ground or robot; empty: from the
///                     scene, or checkerboard
/// @param seed         zero: from the scene, or 1
/// @param diagnostics  receives errors and warnings; with errors, the plan is incomplete
/// @param config       camera and chain to simulate; nullptr: those of a first configuration
/// @param surface      reads the robot's surface for target robot; empty: that target is refused
/// @throws InputError  if a file cannot be read, or nothing can be calibrated with this target
[[nodiscard]] SimulationPlan read_simulation(const Robot& robot, const std::string& path,
                                             const std::string& target, std::uint64_t seed,
                                             Diagnostics& diagnostics,
                                             const Config* config = nullptr,
                                             const std::function<RobotSurface()>& surface = {});

/// The poses of a plan: those of its file, or generated ones.
/// @throws InputError  if there is no pose in which the camera sees the target
[[nodiscard]] std::vector<JointTarget> poses_of(const SimulationPlan& plan);

}  // namespace kinecal
