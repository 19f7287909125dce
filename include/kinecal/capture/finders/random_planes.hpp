// The plane with the most points near it, by random sampling.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/geometry/rotation.hpp"
#include "kinecal/sensors/quantity.hpp"

namespace kinecal {

/// Settings of the search for a plane.
struct PlaneSearch {
  double tolerance = 0.02;   ///< initial distance from the plane, metres
  int iterations = 1000;     ///< largest number of random planes
  std::uint64_t seed = 1;    ///< of the random planes
  double least_share = 0.2;  ///< least fraction of the points on the plane
  /// (3) expected direction of the normal, of any length and sign; 0: any.
  Vector3<double> normal = Vector3<double>::Zero();
  double normal_angle = 0.349065;  ///< largest angle between the normals, radians: 20 degrees
  std::optional<double> offset;    ///< expected distance from the origin along `normal`, metres
  double offset_tolerance = 0.1;   ///< metres
};

/// A plane and the number of points on it.
struct ScoredPlane {
  Plane<double> plane;
  std::size_t count = 0;
};

/// The best of random planes.
/// @param points    (3) metres, finite; all are scored
/// @param by_prior  only planes near the expected one
[[nodiscard]] ScoredPlane best_plane(std::span<const Vector3<double>> points,
                                     const PlaneSearch& search, bool by_prior);

/// Least squares on the points within the tolerance of a plane; nullopt if they do not determine
/// one.
[[nodiscard]] std::optional<Plane<double>> refitted_plane(std::span<const Vector3<double>> points,
                                                          const Plane<double>& plane,
                                                          double tolerance);

/// How a plane differs from the expected one, as a sentence; empty if it does not.
/// @param slack  factor of the tolerances
[[nodiscard]] std::string plane_off_prior(const Plane<double>& plane, const PlaneSearch& search,
                                          double slack = 1.0);

/// Signed distance of a point from a plane, metres.
[[nodiscard]] inline double plane_distance(const Plane<double>& plane, const Vector3<double>& p) {
  return plane.normal.dot(p - plane.centroid);
}

/// Points that are within the tolerance of a plane, or those that are not.
[[nodiscard]] std::vector<Vector3<double>> points_near_plane(
    std::span<const Vector3<double>> points, const Plane<double>& plane, double tolerance,
    bool on_it = true);

}  // namespace kinecal
