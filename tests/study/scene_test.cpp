#include "kinecal/study/scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stdexcept>

namespace kinecal {
namespace {

TEST(Scene, APatchFacesWhereItIsTold) {
  const Pose<double> pose = facing({1, 2, 3}, {0, 2, 0});
  EXPECT_TRUE(pose.rotation.col(2).isApprox(Vector3<double>(0, -1, 0)));
  EXPECT_TRUE(pose.rotation.col(1).isApprox(Vector3<double>(0, 0, -1)));
  EXPECT_NEAR(pose.rotation.determinant(), 1.0, 1e-12);
  EXPECT_NEAR(facing({0, 0, 0}, {0, 0, 1}).rotation.determinant(), 1.0, 1e-12);  // no "down" there
}

TEST(Scene, TheSidesOfABoxEncloseIt) {
  Scene scene;
  const Pose<double> link_T_box{exp(Vector3<double>(0.3, 0.2, 0.1)), {1.0, 0.0, 0.5}};
  add_box(scene, "hand", link_T_box, {0.2, 0.4, 0.6});
  ASSERT_EQ(scene.patches.size(), 6U);
  double area = 0.0;
  for (const Patch& side : scene.patches) {
    const Vector3<double> out = side.pose.translation - link_T_box.translation;
    EXPECT_NEAR(out.normalized().dot(side.pose.rotation.col(2)), -1.0, 1e-12);
    EXPECT_EQ(side.link, "hand");
    area += side.width * side.height;
  }
  EXPECT_NEAR(area, 2 * (0.2 * 0.4 + 0.4 * 0.6 + 0.2 * 0.6), 1e-12);
}

TEST(Scene, ACheckerboardsOriginIsItsFirstInnerCorner) {
  Scene scene;
  add_checkerboard(scene, "hand", {}, 4, 3, 0.02);
  const Patch& board = scene.patches.at(0);
  ASSERT_EQ(board.texture->width, 4 + 1 + 2);
  ASSERT_EQ(board.texture->height, 3 + 1 + 2);
  EXPECT_NEAR(board.pose.translation.x() - board.width / 2, -0.04, 1e-12);
  EXPECT_NEAR(board.pose.translation.y() - board.height / 2, -0.04, 1e-12);
  const GrayImage& squares = *board.texture;
  EXPECT_EQ(squares(1, 1), squares(2, 2));  // they meet at the first corner
  EXPECT_NE(squares(1, 1), squares(2, 1));
  EXPECT_EQ(squares(0, 0), squares(6, 5));  // the margin
  EXPECT_THROW(add_checkerboard(scene, "", {}, 0, 3, 0.02), std::invalid_argument);
  EXPECT_THROW(add_picture(scene, "", {}, nullptr, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
