// The 3-D point between the pixels of an organised cloud; tolerates holes and noise.
//
// On a plane, x/z, y/z and 1/z of a camera's points are linear in the pixel (u, v), for any
// intrinsics.  So each is fitted linearly to the surrounding points and evaluated at the place.
// Points off the plane, such as those behind the edge of a board, are dropped: those further from
// the plane of least median error than five times that error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kinecal/capture/image.hpp"

namespace kinecal {

/// The point of a surface at (u, v).
/// @param points  organised cloud: that of a pixel of the image
/// @param pixel   (2) u, v
/// @param reach   radius of the points used, pixels; at least 1
/// @returns       (3) metres, in the cloud's frame; nullopt if fewer than half of these points are
///                valid or all are on one side
[[nodiscard]] std::optional<Vector3<double>> point_at(const PointCloud& points,
                                                      const Eigen::Vector2d& pixel, double reach);

}  // namespace kinecal
