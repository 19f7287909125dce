#include "kinecal/capture/finders/plane_search.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinecal {
namespace {

using Points = std::vector<Vector3<double>>;

/// Points on z = 0.1 x + 0.5, with noise; then others anywhere in a cube.
Points points_with(int on_plane, int others, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise);
  Points points;
  for (int i = 0; i < on_plane; ++i) {
    const double x = at(random), y = at(random);
    points.emplace_back(x, y, 0.1 * x + 0.5 + normal(random));
  }
  for (int i = 0; i < others; ++i) points.emplace_back(at(random), at(random), at(random));
  return points;
}

TEST(PlaneSearch, FindsThePlaneAmongManyOutliers) {
  const Vector3<double> truth = Vector3<double>(-0.1, 0.0, 1.0).normalized();
  for (unsigned seed = 0; seed < 20; ++seed) {
    PlaneSearch search;
    search.seed = seed;
    const FoundPlane found = find_plane(points_with(1000, 2500, 0.003, seed), search);
    ASSERT_EQ(found.problem, "") << seed;
    EXPECT_GT(std::abs(found.plane.normal.dot(truth)), 0.99999) << seed;
    EXPECT_NEAR(found.plane.normal.dot(found.plane.centroid), -0.5 * truth.z(), 0.001) << seed;
    EXPECT_LT(found.tolerance, 0.014) << "follows the noise";
    EXPECT_GT(found.inliers.size(), 950u);
    EXPECT_LT(found.inliers.size(), 1150u);
  }
}

TEST(PlaneSearch, IsTheSameForTheSameSeed) {
  const Points points = points_with(5000, 5000, 0.005, 3);
  const FoundPlane a = find_plane(points, {}), b = find_plane(points, {});
  EXPECT_EQ(a.plane.normal, b.plane.normal);
  EXPECT_EQ(a.inliers, b.inliers);
}

TEST(PlaneSearch, TakesTheSmallerPlaneIfItIsTheExpected) {
  Points points = points_with(1500, 0, 0.003, 1);
  for (const Vector3<double>& p : points_with(2500, 0, 0.003, 2)) {
    points.emplace_back(p.z() + 0.5, p.y(), p.x());  // upright
  }
  PlaneSearch search;
  search.normal = {0.0, 0.0, -3.0};
  search.offset = -0.5;
  const FoundPlane found = find_plane(points, search);
  ASSERT_EQ(found.problem, "");
  EXPECT_LT(found.plane.normal.z(), -0.9) << "the normal is along the expected one";
  EXPECT_LT(found.inliers.back(), 4000u);
}

TEST(PlaneSearch, RefusesPointsThatHaveNoPlane) {
  EXPECT_NE(find_plane({}, {}).problem, "");
  EXPECT_NE(find_plane(Points(500, {1.0, 2.0, 3.0}), {}).problem, "") << "one point";
  Points line;
  for (int i = 0; i < 500; ++i) line.emplace_back(0.01 * i, 0.0, 1.0);
  EXPECT_NE(find_plane(line, {}).problem, "");
  EXPECT_NE(find_plane(points_with(0, 3000, 0.0, 1), {}).problem, "");
}

}  // namespace
}  // namespace kinecal
