#include "kinecal/capture/boards/board_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/board_view.hpp"

namespace kinecal {
namespace {

using test::board_corners;
using test::BoardView;
using testing::HasSubstr;

/// Ids of the corners that are left.
std::vector<int> left_ids(const CameraInfo& camera, std::vector<TargetCorner> corners) {
  EXPECT_EQ(drop_wrong_corners(camera, corners), "");
  std::vector<int> ids;
  for (const TargetCorner& corner : corners) ids.push_back(corner.id);
  return ids;
}

TEST(BoardFit, KeepsEveryRightCornerOfAnyLens) {
  for (const bool fisheye : {false, true}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      BoardView view;
      view.fisheye = fisheye;
      view.focal = fisheye ? 300.0 : 600.0;
      const auto corners = view.see(board_corners(12, 12, 0.04), seed);
      EXPECT_EQ(left_ids(view.camera(), corners).size(), corners.size())
          << (fisheye ? "fisheye" : "pinhole") << ", typical "
          << fit_board(corners, view.camera()).typical;
    }
  }
}

TEST(BoardFit, DropsTheCornersThatAreOffAndNoOthers) {
  for (const bool fisheye : {false, true}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      BoardView view;
      view.fisheye = fisheye;
      auto corners = view.see(board_corners(8, 5, 0.04), seed);
      const std::vector<std::pair<std::size_t, double>> wrong = {{0, 12.9}, {7, 1.5},  {12, 3.0},
                                                                 {13, 6.0}, {39, 1.5}, {35, 9.0}};
      for (const auto& [i, distance] : wrong) {
        corners[i].pixel += distance * Eigen::Vector2d(0.6, -0.8);
      }
      std::vector<TargetCorner> found = corners;
      EXPECT_EQ(drop_wrong_corners(view.camera(), found), "");
      EXPECT_EQ(found.size(), corners.size() - wrong.size()) << "seed " << seed;
      for (const TargetCorner& corner : found) {
        EXPECT_LT((corner.pixel - view.pixel(corner.target)).norm(), 1.0);
      }
    }
  }
}

/// Paper whose upper right curls up by 15 mm, more than a polynomial of degree 3 follows.
TEST(BoardFit, KeepsTheCornersOfAPaperThatCurlsAndDropsThoseThatAreOff) {
  for (const bool fisheye : {false, true}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      BoardView view;
      view.fisheye = fisheye;
      view.focal = fisheye ? 300.0 : 600.0;
      std::vector<TargetCorner> paper = board_corners(12, 12, 0.04);
      for (TargetCorner& corner : paper) {
        const double beyond =
            std::max(0.0, (corner.target.x() + corner.target.y()) / 0.44 - 1.2) / 0.8;
        corner.target.z() = -0.015 * beyond * beyond;
      }
      std::vector<TargetCorner> corners = view.see(paper, seed);
      for (TargetCorner& corner : corners) corner.target.z() = 0.0;
      EXPECT_GE(left_ids(view.camera(), corners).size(), corners.size() - 1)  // the outermost one
          << (fisheye ? "fisheye" : "pinhole");
      std::set<int> wrong;
      for (const std::size_t tag : {16, 110, 130}) {  // four neighbours, as of a tag
        for (const std::size_t i : {tag, tag + 1, tag + 12, tag + 13}) {
          corners[i].pixel += Eigen::Vector2d(2.4, -3.2);
          wrong.insert(corners[i].id);
        }
      }
      const std::vector<int> left = left_ids(view.camera(), corners);
      for (const int id : left) EXPECT_FALSE(wrong.contains(id)) << id;
      EXPECT_GE(left.size(), corners.size() - wrong.size() - 1) << seed;
    }
  }
}

TEST(BoardFit, UsesTheLensOfTheCameraFile) {
  BoardView view;
  CameraInfo camera = view.camera();
  camera.d = {-0.35, 0.12, 0.001, -0.001, 0.0};
  auto corners = board_corners(5, 3, 0.08);
  for (TargetCorner& corner : corners) {
    const Vector3<double> p = view.camera_T_board * corner.target;
    const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
    const double radial = 1.0 - 0.35 * r2 + 0.12 * r2 * r2;
    corner.pixel = {640 + 600 * (x * radial + 2 * 0.001 * x * y - 0.001 * (r2 + 2 * x * x)),
                    480 + 600 * (y * radial + 0.001 * (r2 + 2 * y * y) - 2 * 0.001 * x * y)};
  }
  EXPECT_LT(fit_board(corners, camera).typical, 0.01);
  EXPECT_EQ(left_ids(camera, corners).size(), corners.size());
}

TEST(BoardFit, FewCornersOrCornersInSpaceAreNotJudged) {
  const BoardView view;
  EXPECT_TRUE(fit_board(view.see(board_corners(3, 2, 0.05)), view.camera()).off.empty());
  auto bent = board_corners(5, 4, 0.05);
  bent[3].target.z() = 0.02;
  EXPECT_TRUE(fit_board(view.see(bent), view.camera()).off.empty());
}

TEST(BoardFit, AViewThatContradictsTheTargetIsRefused) {
  const BoardView view;
  std::vector<TargetCorner> corners = view.see(board_corners(6, 4, 0.04));
  for (TargetCorner& corner : corners) {  // of four columns and six rows
    corner.target = {corner.id % 4 * 0.04, corner.id / 4 * 0.04, 0.0};
  }
  EXPECT_THAT(drop_wrong_corners(view.camera(), corners),
              HasSubstr("do not agree with one flat board"));
}

}  // namespace
}  // namespace kinecal
