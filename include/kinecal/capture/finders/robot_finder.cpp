// Definitions of robot_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/robot_finder.hpp"

namespace kinecal {

Found RobotFinder::find(const View& view) const {
  constexpr std::size_t kLeastPoints = 20;
  const PlaneInView ground = plane.plane_in(view);
  if (!ground.problem.empty()) return refused(ground.problem);
  Region box = plane.region;
  box.least = least;
  box.most = most;
  const RegionPoints points = points_in(box, view);
  std::string problem;
  const auto frame_T_camera = pose_in(box, view, problem);
  if (!frame_T_camera) return refused(problem);
  const auto height = [&](const Vector3<double>& p) {
    return ground.found.plane.normal.dot(p - ground.found.plane.centroid);
  };
  const double side = height(frame_T_camera->translation) < 0.0 ? -1.0 : 1.0;
  std::vector<std::size_t> body;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    if (side * height(points.points[i]) > plane.search.tolerance) body.push_back(i);
  }
  if (body.size() < kLeastPoints) {
    return refused("the robot's box has " + std::to_string(body.size()) +
                   " points that are not on the plane; at least " + std::to_string(kLeastPoints) +
                   " are needed");
  }
  Found found;
  found.observations.push_back(observed_evenly(view, plane.camera_sensor, ground.region_points,
                                               ground.found.inliers, plane.points_max,
                                               found.marks));
  found.observations.push_back(
      observed_evenly(view, robot_sensor, points, body, plane.points_max, found.marks));
  return found;
}

}  // namespace kinecal
