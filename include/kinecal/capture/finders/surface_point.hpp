// The 3-D point at a place in a camera's image, even if its depth has holes.
//
// Valid points in a window around the pixel, which grows until there are enough, are split into
// surfaces at gaps in depth.  The surface with the largest weight, 1 / (1 + distance^2), counts;
// one in front of it wins if it has a good part of that weight, because anything attached to an
// edge is on the near side.  On a plane, 1/z is linear in u and v: that fit gives z at the place,
// clamped to the depths seen, and P of the camera gives x and y.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kinecal/capture/view.hpp"

namespace kinecal {

/// The point of the surface at a place of the image.
/// @param view    with camera_info, and a cloud of the image's size
/// @param u,v     pixels, may be between pixels
/// @param radius  half the size of the largest window, pixels
/// @return        (3) metres, in the optical frame; nullopt if there is no depth near the place
[[nodiscard]] std::optional<Vector3<double>> surface_point(const View& view, double u, double v,
                                                           int radius = 12);

}  // namespace kinecal
