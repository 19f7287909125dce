// Generates poses in which a camera sees a target, without teaching the robot.
//
// Starting from a random pose within the limits, one joint at a time is changed until the whole
// target is in the image, large enough, near enough, and not seen from the side.  Poses that touch
// the ground, the robot itself or the line of sight are rejected.  From many such poses, those
// farthest from each other are chosen, with each joint's range counting as one: they spread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

/// A camera, a target, and the requirements on a view of it.
struct ViewGoal {
  std::string base;                            ///< fixed link
  std::string camera;                          ///< optical frame of the camera, a link
  CameraInfo info;                             ///< of the camera
  ImageKind image = ImageKind::automatic;      ///< the kind of its images
  std::string target;                          ///< link that carries the target
  std::vector<Vector3<double>> points;         ///< of the target in that link, metres
  std::optional<Vector3<double>> front = {};   ///< (3) direction of its visible side, in that link
  double nearest = 0.25;                       ///< smallest depth of a point, metres
  double farthest = 1.5;                       ///< largest depth of a point, metres
  double margin = 0.05;                        ///< free fraction of the image at each edge
  double least_size = 0.1;                     ///< of the target, fraction of the image's width
  double most_angle = std::numbers::pi / 4.0;  ///< between its front and the view, radians
  double ground = -std::numeric_limits<double>::infinity();  ///< height in the base, metres
  double radius = 0.05;                  ///< of the robot's links, metres: see RobotBody
  std::vector<std::string> joints = {};  ///< to move; empty: all that move camera or target
  std::map<std::string, double> rest =
      {};  ///< of the others, radians or metres; zero if not listed
};

/// Height of the floor in the base, metres: 0, or below it that of the lowest link that the poses do
/// not move, such as the feet of a robot whose root is its torso.
/// @throws RobotError  if a link or joint does not exist
[[nodiscard]] double floor_height(const Robot& robot, const ViewGoal& goal);

/// Poses in which the camera sees the whole target, spread over the ranges of the joints.
/// @param count    number of poses; fewer if no more are found
/// @param give_up  after so many starts if none came near a view; 0: never
/// @returns      targets for the same joints, in an order with short paths
/// @throws RobotError             if a link or joint does not exist
/// @throws std::invalid_argument  if there is no point, no joint that moves camera against target,
///                                or the camera_info is impossible
/// @throws std::runtime_error     if no pose is found; says what is wrong with the best one
[[nodiscard]] std::vector<JointTarget> poses_with_view_of(const Robot& robot, const ViewGoal& goal,
                                                          int count, std::uint64_t seed = 1,
                                                          int give_up = 0);

}  // namespace kinecal
