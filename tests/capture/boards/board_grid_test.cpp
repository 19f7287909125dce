// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/board_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kinecal {
namespace {

constexpr int kColumns = 6, kRows = 4;
constexpr std::size_t kMoved = 8;

/// Corners of a board that is seen obliquely; one was found elsewhere.
std::vector<TargetCorner> board(double elsewhere) {
  std::vector<TargetCorner> corners;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const double w = 1.0 + 0.02 * c + 0.01 * r;
      corners.push_back({r * kColumns + c,
                         {(100.0 + 40.0 * c + 3.0 * r) / w, (80.0 + 38.0 * r) / w},
                         {0.03 * c, 0.03 * r, 0.0}});
    }
  }
  corners[kMoved].pixel.x() += elsewhere;
  return corners;
}

TEST(BoardGrid, JoinsEachCornerWithItsNeighbours) {
  const std::vector<TargetCorner> corners = board(0.0);
  const auto lines = board_grid(corners, fit_board(corners, {}));
  EXPECT_EQ(lines.size(),
            static_cast<std::size_t>(kRows * (kColumns - 1) + kColumns * (kRows - 1)));
  EXPECT_NEAR(lines.front().u0, corners[0].pixel.x(), 0.01);
  EXPECT_NEAR(lines.front().u1, corners[1].pixel.x(), 0.01);
}

TEST(BoardGrid, PassesBesideACornerThatIsNotWhereItWasFound) {
  const std::vector<TargetCorner> corners = board(3.0);
  const BoardFit fit = fit_board(corners, {});
  EXPECT_NEAR(fit.fitted[kMoved].x(), corners[kMoved].pixel.x() - 3.0, 0.1);
  EXPECT_GT(fit.off[kMoved], fit.limit);
  for (const GridLine& line : board_grid(corners, fit)) {
    const Eigen::Vector2d from(line.u0, line.v0);
    EXPECT_GT((from - corners[kMoved].pixel).norm(), 2.5);
  }
}

TEST(BoardGrid, HasNoLinesWhereTooFewCornersShowTheBoard) {
  std::vector<TargetCorner> corners = board(0.0);
  corners.resize(5);
  EXPECT_TRUE(board_grid(corners, fit_board(corners, {})).empty());
}

}  // namespace
}  // namespace kinecal
