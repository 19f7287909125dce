#include "kinecal/capture/boards/grid_corners.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "support/board_images.hpp"

namespace kinecal::detail {
namespace {

constexpr double kSquare = 0.03;
constexpr int kColumns = 8, kRows = 6;

/// A board before a camera, and where its corners are in the image.
struct SeenBoard {
  test::Target target;
  GrayImage image;
  CameraInfo camera;

  /// Corners that are found at other places of the board than (column, row).
  template <class F>
  [[nodiscard]] CornerGrid grid(const F& place) const {
    CornerGrid grid{kColumns, kRows, {}};
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c) {
        const Eigen::Vector2d at = kSquare * place(c, r);
        grid.corners.push_back(
            test::pixel_of(camera, target.camera_T_board, {at.x(), at.y(), 0.0}));
      }
    }
    return grid;
  }
};

/// A board of 9 x 7 corners, `away` from the axis of a lens.
SeenBoard seen(const CameraInfo& camera, double away, double distance) {
  SeenBoard board;
  board.camera = camera;
  Pose<double> pose = test::facing({0, 0, distance}, 0.2, -0.3, 0.1, {0.12, 0.09, 0});
  const Eigen::AngleAxisd turn(away, Vector3<double>(0.6, 0.8, 0.0));
  pose.rotation = turn * pose.rotation;
  pose.translation = turn * pose.translation;
  board.target = {test::checkerboard(9, 7, kSquare), pose};
  board.image = test::picture(board.camera, {board.target});
  return board;
}

std::vector<SeenBoard> boards() {
  const double degree = std::numbers::pi / 180.0;
  const CameraInfo fisheye = test::fisheye_camera(800, 800, 190 * degree);
  return {seen(test::camera_640(), 0.0, 0.5), seen(fisheye, 0.0, 0.1), seen(fisheye, 0.6, 0.15),
          seen(fisheye, 60 * degree, 0.2)};
}

Eigen::Vector2d right_place(int c, int r) {
  return {c, r};
}

TEST(GridCorners, OfABoardInAnyLensAreThoseOfACheckerboard) {
  for (const SeenBoard& board : boards()) {
    EXPECT_TRUE(is_checkerboard(board.image, board.grid(right_place)));
  }
}

TEST(GridCorners, SkippedRowsAndColumnsAreNotACheckerboard) {
  for (const SeenBoard& board : boards()) {
    for (int skipped = 1; skipped < kColumns; ++skipped) {
      EXPECT_FALSE(is_checkerboard(board.image, board.grid([&](int c, int r) {
        return Eigen::Vector2d(c >= skipped ? c + 1 : c, r);
      }))) << "column "
           << skipped;
      if (skipped >= kRows) continue;
      EXPECT_FALSE(is_checkerboard(board.image, board.grid([&](int c, int r) {
        return Eigen::Vector2d(c, r >= skipped ? r + 1 : r);
      }))) << "row "
           << skipped;
    }
  }
}

TEST(GridCorners, ExchangedCornersAndRowsAreNotACheckerboard) {
  for (const SeenBoard& board : boards()) {
    CornerGrid neighbours = board.grid(right_place);
    std::swap(neighbours.corners[kColumns + 2], neighbours.corners[kColumns + 3]);
    EXPECT_FALSE(is_checkerboard(board.image, neighbours));
    EXPECT_FALSE(is_checkerboard(board.image, board.grid([](int c, int r) {
      return Eigen::Vector2d(c, r < 2 ? 1 - r : r);
    })));
  }
}

TEST(GridCorners, OneOnAnotherFeatureIsNotOfACheckerboard) {
  for (const SeenBoard& board : boards()) {
    for (const int wrong : {0, 3, kColumns + 1, 3 * kColumns + 4, kRows * kColumns - 1}) {
      EXPECT_FALSE(is_checkerboard(board.image, board.grid([&](int c, int r) {
        const bool is_wrong = r * kColumns + c == wrong;
        return Eigen::Vector2d(c + (is_wrong ? 0.6 : 0.0), r - (is_wrong ? 0.5 : 0.0));
      }))) << wrong;
    }
  }
}

TEST(GridCorners, GlareIsJudgedBetweenCornersWhereSquaresAreWhole) {
  SeenBoard board = seen(test::camera_640(), 0.0, 0.5);
  board.target.print = test::checkerboard(kColumns, kRows, kSquare, 0.4);
  const test::Exposure how{.white = 255.0, .background = 255.0};
  board.image = test::picture(board.camera, {board.target}, how);
  EXPECT_EQ(glare_share(board.image, board.grid(right_place)), 0.0);
}

TEST(GridCorners, PaintHidesAllSquaresOfABentBoard) {
  for (const SeenBoard& board : boards()) {
    GrayImage image = board.image;
    paint_over(board.grid(right_place), image);
    for (int i = 0; i < 200; ++i) {
      const double x = 0.5 * (i % 16), y = 0.5 * (i / 16);
      if (x > kColumns - 1 || y > kRows - 1) continue;
      const Eigen::Vector2d at = test::pixel_of(board.camera, board.target.camera_T_board,
                                                {x * kSquare, y * kSquare, 0.0});
      const Eigen::Vector2d origin =
          test::pixel_of(board.camera, board.target.camera_T_board, {0.0, 0.0, 0.0});
      EXPECT_NEAR(brightness_at(image, at), brightness_at(image, origin), 1.0) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace kinecal::detail
