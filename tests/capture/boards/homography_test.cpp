#include "kinecal/capture/boards/homography.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"

namespace kinecal {
namespace {

std::vector<Eigen::Vector2d> grid_places() {
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < 20; ++i) places.emplace_back(i % 5 * 0.03, i / 5 * 0.03);
  return places;
}

TEST(Homography, FindsTheMapOfAPlane) {
  Matrix3<double> truth;
  truth << 500, 20, 300, -10, 480, 200, 0.1, -0.2, 1;
  std::vector<Eigen::Vector2d> to;
  for (const auto& p : grid_places()) to.push_back(mapped(truth, p));
  const auto h = homography(grid_places(), to);
  ASSERT_TRUE(h);
  EXPECT_LT((mapped(*h, {0.5, -0.2}) - mapped(truth, {0.5, -0.2})).norm(), 1e-6);
}

TEST(Homography, PointsOnALineOrTooFewDetermineNothing) {
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i < 6; ++i) line.emplace_back(i, 2.0 * i);
  EXPECT_FALSE(homography(line, line));
  EXPECT_FALSE(homography({{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {1, 0}, {0, 1}}));
}

TEST(Homography, ThePoseOfABoardIsFoundFromRaysAndFromPoints) {
  SeededRandom random(3);
  for (int k = 0; k < 20; ++k) {
    const Pose<double> truth = kinecal::test::facing(
        {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.3, 1.5)},
        random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-3, 3),
        {0.06, 0.045, 0});
    std::vector<Eigen::Vector2d> rays;
    std::vector<Vector3<double>> in_camera, on_board;
    for (const auto& p : grid_places()) {
      on_board.emplace_back(p.x(), p.y(), 0.0);
      in_camera.push_back(truth * on_board.back());
      rays.emplace_back(in_camera.back().head<2>() / in_camera.back().z());
    }
    const auto seen = plane_pose(grid_places(), rays), fitted = rigid_fit(in_camera, on_board);
    ASSERT_TRUE(seen && fitted);
    EXPECT_LT((seen->rotation - truth.rotation).norm(), 1e-6);
    EXPECT_LT((seen->translation - truth.translation).norm(), 1e-6);
    EXPECT_LT((fitted->rotation - truth.rotation).norm(), 1e-9);
    EXPECT_LT((fitted->translation - truth.translation).norm(), 1e-9);
  }
}

TEST(Homography, ARigidFitNeedsPointsThatAreNotOnALine) {
  EXPECT_FALSE(rigid_fit({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
}

}  // namespace
}  // namespace kinecal
