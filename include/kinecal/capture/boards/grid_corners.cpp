// Definitions of grid_corners.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/grid_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kinecal/capture/boards/board_order.hpp"
#include "kinecal/capture/boards/homography.hpp"

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

/// True if corners are within a third of a square of a flat grid.
[[nodiscard]] bool is_flat(const CornerGrid& grid) {
  std::vector<Eigen::Vector2d> places;
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) places.emplace_back(c, r);
  }
  const auto h = homography(places, grid.corners);
  if (!h) return false;
  const double limit = smallest_side(grid) / 3.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!((mapped(*h, places[i]) - grid.corners[i]).norm() <= limit)) return false;
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
  if (!is_flat(grid)) return false;
  const int dark =
      even_squares_brighter(image, grid.columns, grid.rows, grid.corners) < 0.0 ? 0 : 1;
  int pairs = 0, differ = 0;
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 2 < grid.columns; ++c) {
      const auto first = darkest_and_brightest(image, grid, c, r),
                 second = darkest_and_brightest(image, grid, c + 1, r);
      const bool first_dark = (c + r) % 2 == dark;
      ++pairs;
      if (first_dark ? first[1] < second[0] : second[1] < first[0]) ++differ;
    }
  }
  return 10 * differ >= 9 * pairs;
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
  for (int r = -1; r < grid.rows; ++r) {
    for (int c = -1; c < grid.columns; ++c) {
      if ((r + c + 2) % 2 != dark) continue;
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
  const std::array<Eigen::Vector2d, 4> outline = {grid.at(-1, -1), grid.at(grid.columns, -1),
                                                  grid.at(grid.columns, grid.rows),
                                                  grid.at(-1, grid.rows)};
  double sum = 0.0;
  for (const auto& c : grid.corners) sum += brightness_at(image, c);
  const auto grey = static_cast<std::uint8_t>(
      sum / static_cast<double>(std::max<std::size_t>(grid.corners.size(), 1)));
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      int left = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector2d side = outline[(k + 1) % 4] - outline[k];
        const Eigen::Vector2d to = Eigen::Vector2d(u, v) - outline[k];
        left += side.x() * to.y() - side.y() * to.x() >= 0.0 ? 1 : -1;
      }
      if (std::abs(left) == 4) image(u, v) = grey;
    }
  }
}

}  // namespace kinecal::detail
