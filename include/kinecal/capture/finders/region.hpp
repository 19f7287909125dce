// The region that finders search: a box in a frame of the robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// The pose frame_T_camera of a view's camera in some frame of the robot, from the robot model and
/// the view's joints; nullopt if they do not determine it.
using PoseOfView = std::function<std::optional<Pose<double>>(const View&)>;

/// Gives the pose of the camera in a link of the robot.
using CameraIn = std::function<PoseOfView(const std::string& link)>;

/// A box in a frame.
struct Region {
  std::string frame;  ///< for messages: transform_frame of upstream; empty: the camera's own
  PoseOfView frame_T_camera;               ///< empty: the camera's own frame
  Vector3<double> least{-2.0, -2.0, 0.0};  ///< (3) min_x min_y min_z, metres, in the frame
  Vector3<double> most{2.0, 2.0, 2.0};     ///< (3) max_x max_y max_z, metres, in the frame

  /// True if a point (3), metres, in the frame, is in the box.
  [[nodiscard]] bool contains(const Vector3<double>& p) const {
    return p.x() >= least.x() && p.y() >= least.y() && p.z() >= least.z() && p.x() <= most.x() &&
           p.y() <= most.y() && p.z() <= most.z();
  }
};

/// Points of a cloud that are in a region.
struct RegionPoints {
  std::vector<Vector3<double>> points;  ///< (3) metres, in the region's frame
  std::vector<std::size_t> indices;     ///< of each in the cloud
  std::string problem;                  ///< why they are missing
};

/// The pose of a view's camera in a region's frame.
/// @param[out] problem  why it is missing: missing joints
[[nodiscard]] std::optional<Pose<double>> pose_in(const Region& region, const View& view,
                                                  std::string& problem);

/// Valid points in a region; some drivers mark missing points by the camera's origin.
[[nodiscard]] RegionPoints points_in(const Region& region, const View& view);

/// Observation of some points of a view's cloud, in its frame, with marks if the cloud is
/// organised.
/// @param sensor   its name
/// @param indices  of points in the cloud
[[nodiscard]] Observation observed_points(const View& view, const std::string& sensor,
                                          const std::vector<std::size_t>& indices,
                                          std::vector<Mark>& marks);

}  // namespace kinecal
