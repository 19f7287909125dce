// Wraps OpenCV: grids of discs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// Why this build cannot find grids of discs; empty if it can.
[[nodiscard]] std::string circles_fault();

/// About the middles of the black discs of a grid, row by row, in one of its orders; empty if there is no
/// such grid.  Larger images than 1600 pixels are searched at reduced size.
/// @param columns, rows  discs of a row, and rows; at least 2
/// @param asymmetric     every other row is shifted by half a step
[[nodiscard]] std::vector<Eigen::Vector2d> find_circles(const GrayImage& image, int columns,
                                                        int rows, bool asymmetric);

}  // namespace kinecal::detail
