// Corners of a grid of squares in an image: size of the squares, extent, sharpness and brightness.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kinecal/capture/boards/square_edges.hpp"

namespace kinecal::detail {

/// Corners of a checkerboard, row by row.
struct CornerGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector2d> corners = {};  ///< (columns * rows) pixels

  /// A corner; beyond the grid, extrapolated from the two before it.
  [[nodiscard]] Eigen::Vector2d at(int column, int row) const;
};

/// The shortest side of a square, pixels.
[[nodiscard]] double smallest_side(const CornerGrid& grid);

/// True if corners can be those of a flat board that a lens has bent, of up to 190 degrees: distances from
/// corner to corner change smoothly along rows and columns; and squares are uniformly dark and bright in
/// turn: nine of ten pairs of neighbours, and half of those in each row and column.
[[nodiscard]] bool is_checkerboard(const GrayImage& image, const CornerGrid& grid);

/// True if squares continue beyond a side: the grid is part of a larger board.
[[nodiscard]] bool goes_on(const GrayImage& image, const CornerGrid& grid);

/// The edges between neighbouring corners, those along rows and those along columns.
struct GridEdges {
  std::vector<EdgeMeasure> edges[2];
};
[[nodiscard]] GridEdges edges_of(const GrayImage& image, const CornerGrid& grid);

/// Fraction of the pixels of dark squares between corners that are saturated.  Those around them may be cut, or
/// not as wide.
[[nodiscard]] double glare_share(const GrayImage& image, const CornerGrid& grid);

/// Paints a grid and one square around it in one grey, so that it is not found again.
void paint_over(const CornerGrid& grid, GrayImage& image);

}  // namespace kinecal::detail
