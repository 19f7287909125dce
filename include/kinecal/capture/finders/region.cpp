// Definitions of region.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/region.hpp"

#include "kinecal/capture/finders/view_checks.hpp"

namespace kinecal {

std::optional<Pose<double>> pose_in(const Region& region, const View& view, std::string& problem) {
  if (!region.frame_T_camera) return Pose<double>{};
  std::optional<Pose<double>> pose = region.frame_T_camera(view);
  if (pose && pose->rotation.allFinite() && pose->translation.allFinite()) return pose;
  problem = "the joints of the view do not give the pose of '" + view.frame + "' in '" +
            region.frame + "'";
  return std::nullopt;
}

RegionPoints points_in(const Region& region, const View& view) {
  RegionPoints found;
  found.problem = cloud_problem(view);
  if (!found.problem.empty()) return found;
  const auto frame_T_camera = pose_in(region, view, found.problem);
  if (!frame_T_camera) return found;
  const std::vector<Vector3<float>>& cloud = view.points.pixels;
  found.points.reserve(cloud.size());
  found.indices.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3<double> p = cloud[i].cast<double>();
    if (p.isZero(0.0)) continue;
    const Vector3<double> moved = *frame_T_camera * p;
    if (!region.contains(moved) || !moved.allFinite()) continue;
    found.points.push_back(moved);
    found.indices.push_back(i);
  }
  return found;
}

Observation observed_points(const View& view, const std::string& sensor,
                            const std::vector<std::size_t>& indices, std::vector<Mark>& marks) {
  Observation observation{sensor, {}, view.camera};
  const auto width = static_cast<std::size_t>(view.points.width);
  for (const std::size_t i : indices) {
    Feature feature;
    feature.frame = view.frame;
    feature.point = view.points.pixels[i].cast<double>();
    observation.features.push_back(feature);
    if (view.points.height > 1) {
      const std::size_t column = i % width, row = i / width;
      marks.push_back({static_cast<double>(column), static_cast<double>(row), {}});
    }
  }
  return observation;
}

}  // namespace kinecal
