// Sub-pixel corners of a square tag, from its four edges.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// Moves the corners of a tag to the intersections of its four edges.  Each line is fitted to the
/// places where the brightness is halfway between both sides.
/// @param cell  width of the border, pixels
void refine_tag(const GrayImage& image, double cell, std::array<Eigen::Vector2d, 4>& corners);

}  // namespace kinecal::detail
