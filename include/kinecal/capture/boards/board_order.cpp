// Definitions of board_order.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/board_order.hpp"

#include <algorithm>

#include "kinecal/capture/boards/square_edges.hpp"

namespace kinecal {

int turns_alike(int columns, int rows) {
  if ((columns + rows) % 2 != 0) return 4;
  return columns == rows && columns % 2 == 0 ? 1 : 2;
}

std::vector<std::size_t> turned_order(int columns, int rows, int quarter_turns) {
  const int turns = ((quarter_turns % 4) + 4) % 4;
  std::vector<std::size_t> order;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      int c = column, r = row;
      for (int k = 0; k < turns % 2; ++k) {
        const int last = c;  // of a square board
        c = columns - 1 - r;
        r = last;
      }
      if (turns >= 2) {
        c = columns - 1 - c;
        r = rows - 1 - r;
      }
      order.push_back(static_cast<std::size_t>(r * columns + c));
    }
  }
  return order;
}

double even_squares_brighter(const GrayImage& image, int columns, int rows,
                             const std::vector<Eigen::Vector2d>& corners) {
  double sums[2] = {0.0, 0.0};
  int counts[2] = {0, 0};
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < columns; ++c) {
      const int place = r * columns + c;
      const auto i = static_cast<std::size_t>(place);
      const auto j = i + static_cast<std::size_t>(columns);
      const Eigen::Vector2d middle =
          (corners[i] + corners[i + 1] + corners[j] + corners[j + 1]) / 4.0;
      sums[(r + c) % 2] += brightness_at(image, middle);
      ++counts[(r + c) % 2];
    }
  }
  return sums[0] / std::max(counts[0], 1) - sums[1] / std::max(counts[1], 1);
}

void order_corners(const GrayImage& image, int columns, int rows,
                   std::vector<Eigen::Vector2d>& corners) {
  const std::size_t across = static_cast<std::size_t>(columns) - 1;
  const std::size_t down = (static_cast<std::size_t>(rows) - 1) * static_cast<std::size_t>(columns);
  const Eigen::Vector2d x = corners[across] - corners[0], y = corners[down] - corners[0];
  if (x.x() * y.y() - x.y() * y.x() < 0.0) {  // mirrored: read each row backwards
    for (auto row = corners.begin(); row != corners.end(); row += columns) {
      std::reverse(row, row + columns);
    }
  }
  const auto turned = [&](int turns) {
    std::vector<Eigen::Vector2d> list;
    for (const std::size_t i : turned_order(columns, rows, turns)) list.push_back(corners[i]);
    return list;
  };
  const int step = columns == rows ? 1 : 2;
  std::vector<Eigen::Vector2d> best;
  for (int turns = 0; turns < 4; turns += step) {
    const std::vector<Eigen::Vector2d> list = turned(turns);
    if (even_squares_brighter(image, columns, rows, list) > 0.0 &&
        turns_alike(columns, rows) != step) {
      continue;
    }
    if (best.empty() ||
        (list[across] - list[0]).normalized().x() > (best[across] - best[0]).normalized().x()) {
      best = list;
    }
  }
  if (!best.empty()) corners = best;
}

}  // namespace kinecal
