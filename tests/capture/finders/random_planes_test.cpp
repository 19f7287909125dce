#include "kinecal/capture/finders/random_planes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::HasSubstr;

const Plane<double> kFloor{{1.0, 2.0, 0.25}, {0.0, 0.0, -1.0}};

TEST(RandomPlanes, ThePriorHasNoSign) {
  PlaneSearch search;
  EXPECT_EQ(plane_off_prior(kFloor, search), "");
  search.normal = {0.0, 0.1, 2.0};
  EXPECT_EQ(plane_off_prior(kFloor, search), "");
  search.offset = 0.3;
  EXPECT_EQ(plane_off_prior(kFloor, search), "");
  search.offset = -0.25;
  EXPECT_THAT(plane_off_prior(kFloor, search), HasSubstr("it is at"));
  search.normal = {0.0, 1.0, 1.0};
  EXPECT_THAT(plane_off_prior(kFloor, search), HasSubstr("tilted by 45 deg"));
  search.offset.reset();
  EXPECT_EQ(plane_off_prior(kFloor, search, 3.0), "");
}

TEST(RandomPlanes, FewPointsHaveNone) {
  std::vector<Vector3<double>> points(2, Vector3<double>::Zero());
  EXPECT_EQ(best_plane(points, {}, false).count, 0u);
  EXPECT_FALSE(refitted_plane(points, kFloor, 10.0).has_value());
  points = {{0, 0, 0.25}, {1, 0, 0.25}, {0, 1, 0.25}, {0, 0, 5.0}};
  EXPECT_EQ(points_near_plane(points, kFloor, 0.01).size(), 3u);
  EXPECT_EQ(points_near_plane(points, kFloor, 0.01, false).size(), 1u);
  const auto plane = refitted_plane(points, kFloor, 0.01);
  ASSERT_TRUE(plane.has_value());
  EXPECT_NEAR(std::abs(plane->normal.z()), 1.0, 1e-12);
  EXPECT_GE(best_plane(points, {}, false).count, 3u);
}

}  // namespace
}  // namespace kinecal
