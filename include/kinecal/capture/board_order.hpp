// The order of a checkerboard's corners, which a finder returns in any of its four turns.
//
// Corners are numbered row by row from the first, along x then y, as the board is looked at: x to the
// right, y down, z away from the viewer.  A board of columns x rows inner corners looks the same when
// it is turned by
//   180 degrees  if columns + rows is even
//   90 degrees   if columns = rows, even
// and else its colours decide: the square behind the first corner is dark.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal {

/// The smallest number of quarter turns after which a board looks the same: 1, 2, or 4.
/// @param columns, rows  inner corners
[[nodiscard]] int turns_alike(int columns, int rows);

/// Which corner takes the place of each when the board is turned about its normal.
/// @param quarter_turns  of 90 degrees; even unless columns = rows
/// @returns              (columns * rows) indices
[[nodiscard]] std::vector<std::size_t> turned_order(int columns, int rows, int quarter_turns);

/// Puts corners, found row by row in any turn or mirrored, in the board's order.  Where turns look
/// alike, x is the one nearest to the image's right.
/// @param corners  (columns * rows) pixels
void order_corners(const GrayImage& image, int columns, int rows,
                   std::vector<Eigen::Vector2d>& corners);

/// Mean brightness of the squares between corners whose column + row is even, less that of the
/// others: negative if the square behind the first corner is dark.
[[nodiscard]] double even_squares_brighter(const GrayImage& image, int columns, int rows,
                                           const std::vector<Eigen::Vector2d>& corners);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/board_order.ipp"
#endif
