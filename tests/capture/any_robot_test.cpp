#include "kinecal/capture/any_robot.hpp"

#include <gtest/gtest.h>

#include "support/toy_robot.hpp"

namespace kinecal {
namespace {

TEST(AnyRobot, ForwardsToTheRobotThatItHolds) {
  test::ToyArm arm;
  test::ToyCamera camera{arm};
  AnyRobot robot{any_arm(arm), {{"square", any_camera(camera)}}, {}};
  robot.arm.move({{"pan"}, {0.5}});
  Stamp now = arm.now;
  for (int i = 0; i < 100; ++i) now = robot.arm.next_joints(now).stamp;
  EXPECT_NEAR(robot.arm.next_joints(now).position("pan").value(), 0.5, 0.01);
  const View view = robot.cameras.at("square").next_view(now);
  EXPECT_GT(view.stamp, now);
  EXPECT_TRUE(test::ToyFinder{}.find(view));
}

TEST(AnyRobot, ForwardsLamps) {
  struct Switch {
    int lit = -1;
    Stamp light(int code) {
      lit = code;
      return Stamp(7);
    }
  } lamp;
  EXPECT_EQ(any_lamp(lamp).light(4), Stamp(7));
  EXPECT_EQ(lamp.lit, 4);
}

}  // namespace
}  // namespace kinecal
