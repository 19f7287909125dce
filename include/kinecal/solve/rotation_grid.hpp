// Rotations that cover all orientations evenly: starts for the search of an unknown orientation.
//
// With s = i + 1/2, t = s / n, the unit quaternion i of n is
//
//   ( sqrt(t) sin a, sqrt(t) cos a, sqrt(1-t) sin b, sqrt(1-t) cos b )     a = 2 pi s / sqrt(2)
//                                                                          b = 2 pi s /
//                                                                          1.5337511687...
//
// With 60 rotations, no orientation is further than 65 degrees from the nearest one.  If fewer than
// three components of the rotation vector are free, the grid covers a circle or a disc.
// Source: Alexa, Super-Fibonacci Spirals: Fast, Low-Discrepancy Sampling of SO(3), 2022.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/rotation.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// One rotation of an even grid.
/// @param index  from 0 to count - 1
/// @param count  number of rotations of the grid
/// @param axes   number of components of the rotation vector that are free: 1, 2 or 3
/// @returns      (3) rotation vector, radians, length at most pi; its first `axes` components are
///               used, the others are zero
[[nodiscard]] Vector3<double> grid_rotation(int index, int count, int axes = 3);

/// The shortest rotation vector of the same rotation.
/// @param vector  (3) rotation vector, radians
/// @returns       (3) length at most pi
[[nodiscard]] Vector3<double> shortest(const Vector3<double>& vector);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/rotation_grid.ipp"
#endif
