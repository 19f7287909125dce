#include "kinecal/kinematics/robot.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

/// Written by position or by name: also where g++ 12 would crash (geometry/pose.hpp).
TEST(Robot, IsWrittenInPlaceWithAnOriginThatIsLeftOut) {
  const Robot by_position("robot",
                          {{"turn", JointType::revolute, "base", "arm", {}, {0, 0, 2}},
                           {"tip", JointType::fixed, "arm", "tip", Pose<double>{}, {1, 0, 0}}});
  const Robot by_name("robot", {{.name = "turn",
                                 .type = JointType::revolute,
                                 .parent = "base",
                                 .child = "arm",
                                 .axis = {0, 0, 2}},
                                {.name = "tip", .parent = "arm", .child = "tip"}});
  for (const Robot& robot : {by_position, by_name}) {
    EXPECT_EQ(robot.joint("tip").type, JointType::fixed);
    EXPECT_EQ(robot.joint("tip").axis, Vector3<double>(1, 0, 0));
    const Joint& turn = robot.joint("turn");
    EXPECT_EQ(turn.axis, Vector3<double>(0, 0, 1)) << "a unit vector";
    EXPECT_EQ(turn.origin.rotation, Matrix3<double>::Identity());
    EXPECT_EQ(turn.origin.translation, Vector3<double>::Zero());
    EXPECT_FALSE(turn.limits || turn.mimic);
  }
}

}  // namespace
}  // namespace kinecal
