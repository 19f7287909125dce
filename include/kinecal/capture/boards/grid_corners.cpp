// Definitions of grid_corners.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/grid_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kinecal/capture/boards/board_order.hpp"

namespace kinecal::detail {

inline constexpr double kSaturatedSquare = 250.0;  // of 255

Eigen::Vector2d CornerGrid::at(int column, int row) const {
  if (column < 0) return 2.0 * at(0, row) - at(1, row);
  if (row < 0) return 2.0 * at(column, 0) - at(column, 1);
  if (column >= columns) return 2.0 * at(columns - 1, row) - at(columns - 2, row);
  if (row >= rows) return 2.0 * at(column, rows - 1) - at(column, rows - 2);
  const int place = row * columns + column;
  return corners[static_cast<std::size_t>(place)];
}

/// Calls f(a, b, direction) for each side of a square; 0 is along rows.
template <class F>
void for_each_side(const CornerGrid& grid, const F& f) {
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      if (c + 1 < grid.columns) f(grid.at(c, r), grid.at(c + 1, r), std::size_t{0});
      if (r + 1 < grid.rows) f(grid.at(c, r), grid.at(c, r + 1), std::size_t{1});
    }
  }
}

double smallest_side(const CornerGrid& grid) {
  double least = std::numeric_limits<double>::infinity();
  for_each_side(grid, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::size_t) {
    least = std::min(least, (b - a).norm());
  });
  return least;
}

/// True if four squares meet at (column, row), which may be beyond the grid: opposite squares are
/// alike, and one pair is darker by half of the board's contrast.
[[nodiscard]] bool squares_meet(const GrayImage& image, const CornerGrid& grid, int column, int row,
                                double contrast) {
  const Eigen::Vector2d at = grid.at(column, row);
  const Eigen::Vector2d x = (grid.at(column + 1, row) - grid.at(column - 1, row)) / 5.0;
  const Eigen::Vector2d y = (grid.at(column, row + 1) - grid.at(column, row - 1)) / 5.0;
  const std::array<double, 4> near = {
      brightness_at(image, at - x - y), brightness_at(image, at + x + y),
      brightness_at(image, at + x - y), brightness_at(image, at - x + y)};
  const double first = std::max(near[0], near[1]), second = std::max(near[2], near[3]);
  return std::min(near[2], near[3]) - first > contrast / 2.0 ||
         std::min(near[0], near[1]) - second > contrast / 2.0;
}

/// True if steps along a line of corners change smoothly: each by less than 60 %, and the change itself by
/// less than half a step.  A skipped or exchanged corner, or one a third of a square off, is not smooth.
[[nodiscard]] bool is_smooth(const std::vector<Eigen::Vector2d>& line) {
  constexpr double kMostChange = 0.6, kMostTurn = 0.5;  // of the mean step
  for (std::size_t i = 2; i < line.size(); ++i) {
    const Eigen::Vector2d step = line[i] - line[i - 1], before = line[i - 1] - line[i - 2];
    if (!((step - before).norm() <= kMostChange * (step.norm() + before.norm()) / 2.0)) {
      return false;
    }
    if (i < 3) continue;
    const Eigen::Vector2d first = line[i - 2] - line[i - 3];
    const double mean = (step.norm() + before.norm() + first.norm()) / 3.0;
    if (!((step - 2.0 * before + first).norm() <= kMostTurn * mean)) return false;
  }
  return true;
}

/// True if rows and columns are smooth, and no square is turned over: of a flat board that any lens may
/// have bent.
[[nodiscard]] bool is_bent_board(const CornerGrid& grid) {
  for (int r = 0; r < grid.rows; ++r) {
    std::vector<Eigen::Vector2d> row;
    for (int c = 0; c < grid.columns; ++c) row.push_back(grid.at(c, r));
    if (!is_smooth(row)) return false;
  }
  for (int c = 0; c < grid.columns; ++c) {
    std::vector<Eigen::Vector2d> column;
    for (int r = 0; r < grid.rows; ++r) column.push_back(grid.at(c, r));
    if (!is_smooth(column)) return false;
  }
  const auto side = [&](int c, int r) {  // which way round the square behind (c, r) is
    const Eigen::Vector2d along = grid.at(c + 1, r + 1) - grid.at(c, r),
                          across = grid.at(c, r + 1) - grid.at(c + 1, r);
    return along.x() * across.y() - along.y() * across.x() > 0.0;
  };
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      if (side(c, r) != side(0, 0)) return false;
    }
  }
  return true;
}

/// The darkest and the brightest of five places in a square, by its first corner.
[[nodiscard]] std::array<double, 2> darkest_and_brightest(const GrayImage& image,
                                                          const CornerGrid& grid, int column,
                                                          int row) {
  constexpr double kPlaces[5][2] = {
      {0.5, 0.5}, {0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}, {0.75, 0.75}};
  const Eigen::Vector2d a = grid.at(column, row), b = grid.at(column + 1, row),
                        c = grid.at(column, row + 1), d = grid.at(column + 1, row + 1);
  std::array<double, 2> range = {255.0, 0.0};
  for (const auto& [s, t] : kPlaces) {
    const double value =
        brightness_at(image, (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * c + s * d));
    range = {std::min(range[0], value), std::max(range[1], value)};
  }
  return range;
}

bool is_checkerboard(const GrayImage& image, const CornerGrid& grid) {
  if (!is_bent_board(grid)) return false;
  const int dark =
      even_squares_brighter(image, grid.columns, grid.rows, grid.corners) < 0.0 ? 0 : 1;
  std::vector<int> in_row(static_cast<std::size_t>(grid.rows)),
      in_column(static_cast<std::size_t>(grid.columns));
  int differ = 0;
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 2 < grid.columns; ++c) {
      const auto first = darkest_and_brightest(image, grid, c, r),
                 second = darkest_and_brightest(image, grid, c + 1, r);
      const bool first_dark = (c + r) % 2 == dark;
      if (!(first_dark ? first[1] < second[0] : second[1] < first[0])) continue;
      ++differ;
      ++in_row[static_cast<std::size_t>(r)];
      ++in_column[static_cast<std::size_t>(c)];
    }
  }
  // A skipped row or column has squares of both colours.
  const int across = grid.columns - 2, down = grid.rows - 1;
  for (int r = 0; r < down; ++r) {
    if (2 * in_row[static_cast<std::size_t>(r)] < across) return false;
  }
  for (int c = 0; c < across; ++c) {
    if (2 * in_column[static_cast<std::size_t>(c)] < down) return false;
  }
  return 10 * differ >= 9 * across * down;
}

bool goes_on(const GrayImage& image, const CornerGrid& grid) {
  const double contrast =
      std::abs(even_squares_brighter(image, grid.columns, grid.rows, grid.corners));
  std::array<int, 4> meet = {0, 0, 0, 0};
  for (int c = 0; c < grid.columns; ++c) {
    meet[0] += squares_meet(image, grid, c, -1, contrast) ? 1 : 0;
    meet[1] += squares_meet(image, grid, c, grid.rows, contrast) ? 1 : 0;
  }
  for (int r = 0; r < grid.rows; ++r) {
    meet[2] += squares_meet(image, grid, -1, r, contrast) ? 1 : 0;
    meet[3] += squares_meet(image, grid, grid.columns, r, contrast) ? 1 : 0;
  }
  return 2 * std::max(meet[0], meet[1]) > grid.columns ||
         2 * std::max(meet[2], meet[3]) > grid.rows;
}

GridEdges edges_of(const GrayImage& image, const CornerGrid& grid) {
  GridEdges all;
  const double reach = 0.45 * smallest_side(grid);
  for_each_side(grid, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::size_t way) {
    if (const auto edge = measure_edge(image, a, b, reach)) all.edges[way].push_back(*edge);
  });
  return all;
}

double glare_share(const GrayImage& image, const CornerGrid& grid) {
  const int dark =
      even_squares_brighter(image, grid.columns, grid.rows, grid.corners) < 0.0 ? 0 : 1;
  int pixels = 0, saturated = 0;
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      if ((r + c) % 2 != dark) continue;
      const Eigen::Vector2d origin = grid.at(c, r), x = grid.at(c + 1, r) - origin,
                            y = grid.at(c, r + 1) - origin;
      for (int k = 0; k < 25; ++k) {
        const int across = k % 5, down = k / 5;
        const double s = 0.3 + 0.1 * across, t = 0.3 + 0.1 * down;
        ++pixels;
        if (brightness_at(image, origin + s * x + t * y) >= kSaturatedSquare) ++saturated;
      }
    }
  }
  return static_cast<double>(saturated) / std::max(pixels, 1);
}

void paint_over(const CornerGrid& grid, GrayImage& image) {
  double sum = 0.0;
  for (const auto& c : grid.corners) sum += brightness_at(image, c);
  const auto grey = static_cast<std::uint8_t>(
      sum / static_cast<double>(std::max<std::size_t>(grid.corners.size(), 1)));
  const auto paint_square = [&](const std::array<Eigen::Vector2d, 4>& corners) {
    Eigen::Vector2d least = corners[0], most = corners[0];
    for (const auto& c : corners) least = least.cwiseMin(c), most = most.cwiseMax(c);
    least = least.cwiseMax(0.0);
    most = most.cwiseMin(Eigen::Vector2d(image.width - 1.0, image.height - 1.0));
    for (int v = static_cast<int>(least.y()); v <= most.y(); ++v) {
      for (int u = static_cast<int>(least.x()); u <= most.x(); ++u) {
        int left = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          const Eigen::Vector2d side = corners[(k + 1) % 4] - corners[k];
          const Eigen::Vector2d to = Eigen::Vector2d(u, v) - corners[k];
          left += side.x() * to.y() - side.y() * to.x() >= 0.0 ? 1 : -1;
        }
        if (std::abs(left) == 4) image(u, v) = grey;
      }
    }
  };
  for (int r = -1; r < grid.rows; ++r) {
    for (int c = -1; c < grid.columns; ++c) {
      paint_square({grid.at(c, r), grid.at(c + 1, r), grid.at(c + 1, r + 1), grid.at(c, r + 1)});
    }
  }
}

}  // namespace kinecal::detail
