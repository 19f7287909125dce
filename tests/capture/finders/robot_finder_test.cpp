#include "kinecal/capture/finders/robot_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/room_scene.hpp"

namespace kinecal {
namespace {

RobotFinder finder_in(const RoomScene& scene) {
  RobotFinder finder;
  finder.plane.region = scene.region();
  finder.plane.search.normal = {0.0, 0.0, 1.0};
  finder.least = {0.3, -0.5, 0.0};
  finder.most = {1.0, 0.5, 1.0};
  return finder;
}

TEST(RobotFinder, SplitsACloudIntoGroundAndRobot) {
  RoomScene scene;
  scene.arm = true;
  const Found found = finder_in(scene).find(scene.view());
  ASSERT_EQ(found.observations.size(), 2u) << found.refusal;
  EXPECT_EQ(found.observations[0].sensor, "camera");
  EXPECT_EQ(found.observations[1].sensor, "camera_robot");
  for (const Feature& f : found.observations[0].features) {
    EXPECT_NEAR((scene.base_T_camera() * f.point).z(), 0.0, 0.02);
  }
  ASSERT_EQ(found.observations[1].features.size(), 60u);
  for (const Feature& f : found.observations[1].features) {
    EXPECT_NEAR((scene.base_T_camera() * f.point).x(), 0.6, 0.02);
  }
}

TEST(RobotFinder, RefusesWhenThereIsNoRobotOrNoGround) {
  RoomScene scene;
  EXPECT_THAT(finder_in(scene).find(scene.view()).refusal,
              testing::HasSubstr("points that are not on the plane"));
  scene.clutter = 1.0;
  EXPECT_THAT(finder_in(scene).find(scene.view()).refusal,
              testing::HasSubstr("no plane dominates"));
  EXPECT_FALSE(finder_in(scene).find(View{}));
}

}  // namespace
}  // namespace kinecal
