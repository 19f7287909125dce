// Shared by finders of printed targets: the sensors that see and hold a target, and the conversion
// of corners to observations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "kinecal/capture/boards/square_edges.hpp"
#include "kinecal/capture/view.hpp"

namespace kinecal {

/// The kind of the camera's features.
enum class CornerKind {
  pixels,  ///< (u, v, 0) of the image, for a camera2d sensor
  points,  ///< of the organised cloud, metres, for a camera3d sensor
  pose     ///< one: the pose of the target in the camera, for two chain6d sensors
};

/// A target's place on the robot, and requirements on its image.
struct TargetSettings {
  std::string camera_sensor = "camera";  ///< the sensor that sees it
  std::string chain_sensor = "arm";      ///< the sensor that holds it
  std::string frame = "checkerboard";    ///< of the target, in which its corners are given
  CornerKind corners = CornerKind::pixels;
  double max_without_depth = 0.1;  ///< fraction of corners that may lack a point; drops these
  TargetQuality quality = {};
};

/// A corner that was found.
struct TargetCorner {
  int id = 0;                          ///< identifies the corner of the target
  Eigen::Vector2d pixel = {0, 0};      ///< (2) u, v
  Vector3<double> target = {0, 0, 0};  ///< (3) metres, in the frame of the target
  double reach = 3.0;                  ///< extent of the target around it, pixels
};

/// Why a view cannot be searched: no image, camera_info missing or of another size, cloud not
/// organised.  Empty if it can.
[[nodiscard]] std::string view_fault(const View& view, CornerKind corners);

/// Marks of corners, with their ids.
[[nodiscard]] std::vector<Mark> marks_of(const std::vector<TargetCorner>& corners);

/// Observations of the camera and of the chain that holds the target, one feature per corner, in
/// the order of the ids, or one pose (target_pose.hpp); or why they are missing.  Corners that are far from where the others put them
/// are left out (board_fit.hpp).
/// @throws std::invalid_argument  if two corners have the same id
[[nodiscard]] Found observed(const View& view, const TargetSettings& settings,
                             std::vector<TargetCorner> corners);

namespace detail {

/// "640 x 480"
[[nodiscard]] std::string pixels_text(int width, int height);

}  // namespace detail

/// Checks settings.
/// @throws std::invalid_argument  if both sensors have the same name, a name is empty, or a limit
///                                is not positive
void check_target(const TargetSettings& settings);

}  // namespace kinecal
