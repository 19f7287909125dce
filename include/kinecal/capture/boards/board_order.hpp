// The order of a checkerboard's corners: a finder returns them in any of four rotations.
//
// Corners are numbered row by row from the first, along x then y, seen from the front: x to the
// right, y down, z away from the viewer.  A board of columns x rows inner corners looks the same
// when rotated by
//   180 degrees  if columns + rows is even
//   90 degrees   if columns = rows, even
// Otherwise its colours decide: the square behind the first corner is dark.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal {

/// The smallest number of quarter turns after which a board looks the same: 1, 2, or 4.
/// @param columns, rows  inner corners
[[nodiscard]] int turns_alike(int columns, int rows);

/// The corner that takes the place of each when the board is rotated about its normal.
/// @param quarter_turns  of 90 degrees; even unless columns = rows
/// @returns              (columns * rows) indices
[[nodiscard]] std::vector<std::size_t> turned_order(int columns, int rows, int quarter_turns);

/// Sorts corners, found row by row in any rotation or mirrored, into the board's order.  If
/// rotations look the same, x points most to the image's right.
/// @param corners  (columns * rows) pixels
void order_corners(const GrayImage& image, int columns, int rows,
                   std::vector<Eigen::Vector2d>& corners);

/// Mean brightness of the squares between corners with even column + row, minus that of the
/// others: negative if the square behind the first corner is dark.
[[nodiscard]] double even_squares_brighter(const GrayImage& image, int columns, int rows,
                                           const std::vector<Eigen::Vector2d>& corners);

}  // namespace kinecal
