#include "kinecal/capture/finders/region.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace kinecal {
namespace {

View view_of(std::vector<Vector3<float>> points) {
  View view;
  view.frame = "optical";
  view.points = PointCloud(static_cast<int>(points.size()), 1, no_point());
  view.points.pixels = std::move(points);
  return view;
}

TEST(Region, KeepsThePointsOfTheBoxInItsFrame) {
  const float infinite = std::numeric_limits<float>::infinity();
  const View view = view_of({{0, 0, 1}, {0, 0, 4}, no_point(), {0, 0, 0}, {infinite, 0, 1}});
  Region region;
  region.frame_T_camera = [](const View&) {
    Pose<double> pose;
    pose.translation.x() = 0.5;
    return pose;
  };
  region.most.x() = std::numeric_limits<double>::infinity();
  const RegionPoints found = points_in(region, view);
  ASSERT_EQ(found.points.size(), 1u);
  EXPECT_EQ(found.indices[0], 0u);
  EXPECT_EQ(found.points[0], Vector3<double>(0.5, 0.0, 1.0));
}

TEST(Region, SaysThatJointsDoNotGiveThePose) {
  Region region;
  region.frame = "base_link";
  region.frame_T_camera = [](const View&) {
    Pose<double> pose;
    pose.translation.x() = std::numeric_limits<double>::quiet_NaN();
    return pose;
  };
  std::string problem;
  EXPECT_FALSE(pose_in(region, view_of({}), problem).has_value());
  EXPECT_THAT(problem, testing::HasSubstr("do not give the pose of 'optical' in 'base_link'"));
}

TEST(Region, MarksPointsOfOrganisedCloudsOnly) {
  View view = view_of({{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}});
  std::vector<Mark> marks;
  EXPECT_EQ(observed_points(view, "camera", {1, 3}, marks).features[1].point.z(), 4.0);
  EXPECT_TRUE(marks.empty());
  view.points.width = view.points.height = 2;
  (void)observed_points(view, "camera", {1, 3}, marks);
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[1].u, 1.0);
  EXPECT_EQ(marks[1].v, 1.0);
}

}  // namespace
}  // namespace kinecal
