#include "kinecal/capture/boards/corner_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal {
namespace {

constexpr double kFocalLength = 300.0;

/// Where the ray through (u, v) meets the plane z = 1 + 0.5 x - 0.3 y.
Vector3<double> on_plane(double u, double v) {
  const double x = (u - 20) / kFocalLength, y = (v - 15) / kFocalLength;
  const double z = 1.0 / (1.0 - 0.5 * x + 0.3 * y);
  return {x * z, y * z, z};
}

PointCloud plane_cloud(double noise = 0.0) {
  SeededRandom random(4);
  PointCloud cloud(40, 30, no_point());
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      const Vector3<double> p = on_plane(u, v);
      cloud(u, v) = Vector3<double>(p * (1.0 + noise * random.normal())).cast<float>();
    }
  }
  return cloud;
}

TEST(CornerDepth, ReadsAPlaneExactlyBetweenPixels) {
  const auto point = point_at(plane_cloud(), {17.3, 11.8}, 4.0);
  ASSERT_TRUE(point);
  EXPECT_LT((*point - on_plane(17.3, 11.8)).norm(), 1e-6);
}

TEST(CornerDepth, AveragesNoise) {
  const auto point = point_at(plane_cloud(0.005), {17.3, 11.8}, 5.0);
  ASSERT_TRUE(point);
  EXPECT_LT((*point - on_plane(17.3, 11.8)).norm(), 0.002);
}

TEST(CornerDepth, FillsHolesButNotWhereMostIsMissing) {
  PointCloud cloud = plane_cloud();
  for (int v = 10; v <= 13; ++v) {
    for (int u = 16; u <= 19; ++u) cloud(u, v) = no_point();
  }
  const auto point = point_at(cloud, {17.3, 11.8}, 4.0);
  ASSERT_TRUE(point);
  EXPECT_LT((*point - on_plane(17.3, 11.8)).norm(), 1e-6);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 18; ++u) cloud(u, v) = no_point();
  }
  EXPECT_FALSE(point_at(cloud, {17.3, 11.8}, 4.0));
  EXPECT_FALSE(point_at(PointCloud{}, {17.3, 11.8}, 4.0));
}

TEST(CornerDepth, LeavesOutWhatLiesBehindTheBoard) {
  PointCloud cloud = plane_cloud(0.001);
  for (int v = 0; v < 30; ++v) {
    for (int u = 20; u < 40; ++u) cloud(u, v) *= 1.5F;
  }
  const auto point = point_at(cloud, {17.3, 11.8}, 4.0);
  ASSERT_TRUE(point);
  EXPECT_LT((*point - on_plane(17.3, 11.8)).norm(), 0.002);
}

}  // namespace
}  // namespace kinecal
