// Definitions of plane_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/plane_finder.hpp"

#include <algorithm>
#include <vector>

#include "kinecal/capture/finders/spread.hpp"
#include "kinecal/capture/finders/view_checks.hpp"

namespace kinecal {

std::string PlaneFinder::fault(const View& view) {
  std::string fault = cloud_problem(view);
  return fault.empty() ? camera_problem(view) : fault;
}

PlaneInView PlaneFinder::plane_in(const View& view) const {
  constexpr std::size_t kLeastPoints = 50;
  PlaneInView plane;
  plane.problem = fault(view);
  if (!plane.problem.empty()) return plane;
  plane.region_points = points_in(region, view);
  plane.problem = plane.region_points.problem;
  if (!plane.problem.empty()) return plane;
  const std::size_t count = plane.region_points.points.size();
  if (count < kLeastPoints) {
    plane.problem = "the box" + (region.frame.empty() ? "" : " in '" + region.frame + "'") +
                    " has " + std::to_string(count) + " points of the cloud; a plane needs " +
                    std::to_string(kLeastPoints);
    return plane;
  }
  plane.found = find_plane(plane.region_points.points, search);
  plane.problem = plane.found.problem;
  return plane;
}

Found PlaneFinder::find(const View& view) const {
  const PlaneInView plane = plane_in(view);
  if (!plane.problem.empty()) return refused(plane.problem);
  Found found;
  found.observations = {observed_evenly(view, camera_sensor, plane.region_points,
                                        plane.found.inliers, points_max, found.marks)};
  return found;
}

Observation observed_evenly(const View& view, const std::string& sensor, const RegionPoints& points,
                            const std::vector<std::size_t>& chosen, std::size_t count,
                            std::vector<Mark>& marks) {
  constexpr std::size_t kPool = 4096;  // spread as evenly as all of them
  std::vector<std::size_t> some;
  std::vector<Vector3<double>> places;
  for (const std::size_t i : thinned(chosen.size(), std::max(kPool, count))) {
    some.push_back(chosen[i]);
    places.push_back(points.points[chosen[i]]);
  }
  std::vector<std::size_t> indices;
  for (const std::size_t i : spread(places, count)) indices.push_back(points.indices[some[i]]);
  return observed_points(view, sensor, indices, marks);
}

}  // namespace kinecal
