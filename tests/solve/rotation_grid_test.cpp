#include "kinecal/solve/rotation_grid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <vector>

namespace kinecal {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// The greatest distance of a random orientation from the nearest of a grid, radians.
/// @param every, first  takes these of the grid only
double coverage(int count, int every = 1, int first = 0) {
  std::vector<Matrix3<double>> grid;
  for (int i = first; i < count; i += every) grid.push_back(exp(grid_rotation(i, count)));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double furthest = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    const Matrix3<double> any = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
    double trace = -1.0;
    for (const Matrix3<double>& r : grid) trace = std::max(trace, r.cwiseProduct(any).sum());
    furthest = std::max(furthest, std::acos(std::min(1.0, 0.5 * (trace - 1.0))));
  }
  return furthest;
}

TEST(RotationGrid, CoversAllOrientations) {
  EXPECT_LT(coverage(60), 65.0 * kDegree);
  EXPECT_LT(coverage(300), 40.0 * kDegree);
}

TEST(RotationGrid, EveryFifthOfThreeHundredIsAnEvenGridAsWell) {
  for (const int first : {0, 1, 4}) EXPECT_LT(coverage(300, 5, first), 65.0 * kDegree) << first;
}

TEST(RotationGrid, GivesVectorsOfHalfATurnAtMost) {
  for (int i = 0; i < 60; ++i) {
    EXPECT_LE(grid_rotation(i, 60).norm(), std::numbers::pi * (1.0 + 1e-15));
  }
}

TEST(RotationGrid, OfOneAxisDividesTheTurnEvenly) {
  for (int i = 0; i < 8; ++i) {
    const Vector3<double> r = grid_rotation(i, 8, 1);
    EXPECT_NEAR(r.x(), (-180.0 + 22.5 + 45.0 * i) * kDegree, 1e-12);
    EXPECT_EQ(r.tail<2>(), Eigen::Vector2d::Zero());
  }
}

TEST(RotationGrid, OfTwoAxesFillsTheDisc) {
  int outer = 0;
  for (int i = 0; i < 60; ++i) {
    const Vector3<double> r = grid_rotation(i, 60, 2);
    EXPECT_EQ(r.z(), 0.0);
    EXPECT_LE(r.norm(), std::numbers::pi);
    outer += r.norm() > std::numbers::pi / std::numbers::sqrt2 ? 1 : 0;
  }
  EXPECT_EQ(outer, 30) << "as many in the outer half of the area as in the inner one";
}

TEST(RotationGrid, ShortestIsTheSameRotation) {
  for (const double angle : {0.0, 1.0, 3.1, 3.2, 5.0, 7.0, 10.0}) {
    const Vector3<double> vector = angle * Vector3<double>(1, -2, 2) / 3.0;
    const Vector3<double> same = shortest(vector);
    EXPECT_LE(same.norm(), std::numbers::pi);
    EXPECT_TRUE(exp(same).isApprox(exp(vector), 1e-12)) << angle;
  }
}

}  // namespace
}  // namespace kinecal
