#include "kinecal/capture/boards/board_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/board_images.hpp"

namespace kinecal {
namespace {

using kinecal::test::camera_640;
using kinecal::test::facing;
using kinecal::test::picture;
using kinecal::test::pixel_of;

/// True if a square board with this many inner corners has the same colours after quarter turns.
bool same_colours(int columns, int rows, int turns) {
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const int x = turns == 2 ? columns - c : columns - r, y = turns == 2 ? rows - r : c;
      if ((x + y) % 2 != (c + r) % 2) return false;
    }
  }
  return true;
}

TEST(BoardOrder, TurnsAlikeAreThoseThatKeepTheColours) {
  for (int columns = 3; columns < 9; ++columns) {
    for (int rows = 3; rows < 9; ++rows) {
      const bool quarter = columns == rows && same_colours(columns, rows, 1);
      const bool half = same_colours(columns, rows, 2);
      EXPECT_EQ(turns_alike(columns, rows), quarter ? 1 : half ? 2 : 4) << columns << " " << rows;
    }
  }
}

TEST(BoardOrder, FourQuarterTurnsAreNone) {
  const auto quarter = turned_order(4, 4, 1);
  auto order = turned_order(4, 4, 0);
  for (int k = 1; k <= 4; ++k) {
    std::vector<std::size_t> next;
    for (const std::size_t i : quarter) next.push_back(order[i]);
    order = next;
    EXPECT_EQ(order, turned_order(4, 4, k)) << k;
  }
}

TEST(BoardOrder, CornersReadInAnyOrderGetTheBoardsOwn) {
  for (const auto& [columns, rows] : {std::pair(5, 4), std::pair(5, 5)}) {
    const auto pose = facing({0, 0, 0.5}, 0.2, 0.1, 0.3, {0.06, 0.06, 0});
    const GrayImage image =
        picture(camera_640(), {{kinecal::test::checkerboard(columns, rows, 0.03), pose}});
    std::vector<Eigen::Vector2d> truth;
    for (int i = 0; i < columns * rows; ++i) {
      truth.push_back(pixel_of(camera_640(), pose, {i % columns * 0.03, i / columns * 0.03, 0.0}));
    }
    std::vector<Eigen::Vector2d> turned(truth.rbegin(), truth.rend()), mirrored = truth;
    for (auto row = mirrored.begin(); row != mirrored.end(); row += columns) {
      std::reverse(row, row + columns);
    }
    order_corners(image, columns, rows, turned);
    order_corners(image, columns, rows, mirrored);
    EXPECT_EQ(turned, truth) << columns;
    EXPECT_EQ(mirrored, truth) << columns;
  }
}

}  // namespace
}  // namespace kinecal
