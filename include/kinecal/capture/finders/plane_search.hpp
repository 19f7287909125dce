// The dominant plane of many points: random samples, then least squares.
//
// Planes through three random points are scored by the number of points within the tolerance.  Each
// new best plane is improved by least squares on its inliers.  The best is fitted to all points;
// then the tolerance shrinks to three times their noise.  A second search among the other points
// checks that the plane is the only one.
// Source: Fischler and Bolles, Random sample consensus, 1981; Chum et al., Locally optimized
// RANSAC, 2003.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "kinecal/capture/finders/random_planes.hpp"

namespace kinecal {

/// A plane and its points.
struct FoundPlane {
  Plane<double> plane;               ///< its normal points to the origin's side, or along `normal`
  std::vector<std::size_t> inliers;  ///< indices of points on it, ascending
  double tolerance = 0.0;            ///< metres, of the inliers
  std::string problem;               ///< why there is no plane
};

/// The plane with the most points on it.
/// @param points  (3) metres, finite, in any frame; the prior is in the same
[[nodiscard]] FoundPlane find_plane(std::span<const Vector3<double>> points,
                                    const PlaneSearch& search);

}  // namespace kinecal
