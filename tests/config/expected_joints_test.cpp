#include "kinecal/config/expected_joints.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(ExpectedJoints, AreThoseThatEndInANameOfTheSamples) {
  const Robot robot("two", {{"left_elbow", JointType::revolute, "a", "b"},
                            {"right_elbow", JointType::revolute, "a", "c"}});
  EXPECT_EQ(expected_joints(robot, {"other", "elbow"}),
            "; the samples have 'elbow': name joints as the URDF does, 'left_elbow' or "
            "'right_elbow'");
  EXPECT_EQ(expected_joints(robot, {"elbow", "left_elbow"}), "");
  EXPECT_EQ(expected_joints(robot, {"elb"}), "");
  EXPECT_EQ(expected_joints(robot, {}), "");
}

}  // namespace
}  // namespace kinecal
