// A plane as features: points on the ground or on a wall, evenly spread.
//
// Only the camera observes it; names and defaults are upstream's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "kinecal/capture/finders/plane_search.hpp"
#include "kinecal/capture/finders/region.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// A plane in a cloud, and the region it was searched in.
struct PlaneInView {
  FoundPlane found;  ///< in the region's frame; inliers are indices of `region_points`
  RegionPoints region_points;
  std::string problem;  ///< why there is no plane
};

/// Finds the dominant plane of a region.
struct PlaneFinder {
  std::string camera_sensor = "camera";  ///< sensor that observes points in the optical frame
  Region region;                         ///< transform_frame, min_x to max_z; upstream: base_link
  PlaneSearch search;                    ///< tolerance, ransac_iterations, normal_a to normal_angle
  std::size_t points_max = 60;           ///< number of features of a plane

  /// Points of the plane in the optical frame.  Without ids: no two views share points.
  [[nodiscard]] Found find(const View& view) const;

  /// Why a view cannot be searched, whatever it shows; empty if it can.
  [[nodiscard]] static std::string fault(const View& view);

  /// Link in which the region is given; empty: the camera's own frame.
  [[nodiscard]] const std::string& region_frame() const { return region.frame; }

  /// Takes the pose of the camera in that link.
  void place_on(const CameraIn& camera_in) { region.frame_T_camera = camera_in(region.frame); }

  /// The plane itself.
  [[nodiscard]] PlaneInView plane_in(const View& view) const;
};
static_assert(Finder<PlaneFinder>);

/// Observation of at most `count` of some points of a view's cloud, evenly spread in space, with
/// marks.
/// @param chosen  places in `points`
[[nodiscard]] Observation observed_evenly(const View& view, const std::string& sensor,
                                          const RegionPoints& points,
                                          const std::vector<std::size_t>& chosen, std::size_t count,
                                          std::vector<Mark>& marks);

}  // namespace kinecal
