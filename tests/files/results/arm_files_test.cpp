#include "kinecal/files/results/arm_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/urdf/joined_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/two_arms.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

TEST(ArmFiles, PrefixesAreThoseBeforeTheSameNames) {
  EXPECT_THAT(arm_prefixes(parse_urdf(test::TwoArms::urdf(), "two_arms.urdf")),
              ElementsAre("left_", "right_"));
  Robot one("panda", {{"panda_joint_1", JointType::revolute, "a", "b"},
                      {"panda_joint_2", JointType::revolute, "b", "c"},
                      {"panda_joint_3", JointType::revolute, "c", "d"},
                      {"panda_joint_4", JointType::revolute, "d", "e"}});
  EXPECT_THAT(arm_prefixes(one), IsEmpty());
}

TEST(ArmFiles, OfArmsOnATorsoAreOriginsOfThoseThatWereCalibrated) {
  const std::string urdf = test::TwoArms::urdf();
  const Robot robot = parse_urdf(urdf, "two_arms.urdf");
  EXPECT_THAT(arm_files(robot, {}, urdf, ""), IsEmpty());
  const auto files = arm_files(robot, {{"right_joint_2", 0.1, {}}}, urdf, "");
  ASSERT_THAT(files, SizeIs(1));
  EXPECT_EQ(files[0].name, "kinematics_right.yaml");
  EXPECT_THAT(files[0].content, AllOf(HasSubstr("right_joint_2:"), Not(HasSubstr("left"))));
}

TEST(ArmFiles, OfRobotsThatWereJoinedAreTheirUrdfs) {
  const std::string arm =
      "<robot name=\"arm\"><link name=\"base\"/><link name=\"hand\"/><joint name=\"elbow\" "
      "type=\"fixed\"><parent link=\"base\"/><child link=\"hand\"/></joint></robot>";
  const std::string urdf =
      joined_urdf(std::vector<RobotPart>{{"a", arm, "a.urdf"}, {"b", arm, "b.urdf"}});
  const auto files = arm_files(parse_urdf(urdf, "robots.urdf"), {}, urdf, "2026_11_30_12_00_00");
  ASSERT_THAT(files, SizeIs(2));
  EXPECT_EQ(files[0].name, "calibrated_a_2026_11_30_12_00_00.urdf");
  EXPECT_THAT(files[1].content, AllOf(HasSubstr("<joint name=\"elbow\""), Not(HasSubstr("b_"))));
}

}  // namespace
}  // namespace kinecal
