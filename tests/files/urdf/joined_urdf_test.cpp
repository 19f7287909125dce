#include "kinecal/files/urdf/joined_urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const char* const kArmUrdf = R"(<?xml version='1.0'?>
<robot name="arm">
  <!-- as its maker wrote it -->
  <material name="grey"><color rgba="1 1 1 1"/></material>
  <link name='base'><visual><geometry><mesh filename="meshes/base.stl"/></geometry>
    <material name="grey"/></visual></link>
  <link name="hand"/><link name="finger"/>
  <joint name="elbow" type="revolute">
    <parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>
    <origin xyz="0.1 0 0.3" rpy="0 0.2 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="grip" type="revolute">
    <parent link="hand"/><child link="finger"/><axis xyz="1 0 0"/><mimic joint="elbow"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <transmission name="t"><joint name="elbow"/><actuator name="m"/></transmission>
  <ros2_control name="arm" type="system">
    <joint name="elbow"><state_interface name="position"/></joint>
    <joint name="grip"><param name="mimic">elbow</param></joint>
  </ros2_control>
  <gazebo reference="hand"><plugin name="p"><joint name="elbow"/></plugin></gazebo>
</robot>
)";

std::vector<RobotPart> two_robots() {
  return {{"left", kArmUrdf, "left.urdf"},
          {"right", kArmUrdf, "right.urdf", "../of_right", {0.0, -1.0, 0.2}, {0.0, 0.0, 0.5}}};
}

TEST(JoinedUrdf, HasEachRobotUnderItsNameWhereItStands) {
  const Robot robot = parse_urdf(joined_urdf(two_robots()), "robots.urdf");
  const Robot alone = parse_urdf(kArmUrdf, "arm.urdf");
  EXPECT_EQ(robot.name(), "left_right");
  EXPECT_THAT(robot.joint_names(),
              testing::UnorderedElementsAre("world_left", "left_elbow", "left_grip", "world_right",
                                            "right_elbow", "right_grip"));
  EXPECT_EQ(robot.joint("right_grip").mimic->joint, "right_elbow");
  const auto at = [](const std::string&) { return 0.4; };
  const Pose<double> base_T_finger = forward_kinematics(make_chain(alone, "base", "finger"), at);
  const RobotPart right = two_robots()[1];
  const Pose<double> stand{rotation_from_rpy(right.rpy), right.xyz};
  const Pose<double> found = forward_kinematics(make_chain(robot, "world", "right_finger"), at);
  constexpr double kSame = 1e-12;
  EXPECT_LE((found.translation - (stand * base_T_finger).translation).norm(), kSame);
  EXPECT_LE((found.rotation - (stand * base_T_finger).rotation).norm(), kSame);
}

TEST(JoinedUrdf, RenamesWhatOtherProgramsReadButNotInsideGazebo) {
  const std::string text = joined_urdf(two_robots());
  for (const char* part :
       {"<transmission name=\"left_t\"><joint name=\"left_elbow\"/><actuator name=\"left_m\"/>",
        "<ros2_control name=\"right_arm\"", "<param name=\"mimic\">right_elbow</param>",
        "<material name=\"right_grey\"/>", "<gazebo reference=\"left_hand\">",
        "<plugin name=\"p\"><joint name=\"elbow\"/>", "<!-- as its maker wrote it -->",
        "filename=\"meshes/base.stl\"", "filename=\"../of_right/meshes/base.stl\""}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(JoinedUrdf, SeparatesEachRobotByteForByte) {
  std::vector<RobotPart> parts = two_robots();
  parts[1].folder.clear();
  const std::string text = joined_urdf(parts);
  EXPECT_THAT(joined_robots(text, "robots.urdf"), ElementsAre("left", "right"));
  const std::string arm(kArmUrdf);
  const std::string inside = arm.substr(arm.find("<robot"));
  for (const char* name : {"left", "right"}) {
    const std::string alone = separated_urdf(text, "robots.urdf", name);
    EXPECT_EQ(alone.substr(alone.find("<robot")), inside) << name;
  }
  EXPECT_THAT(
      test::thrown<InputError>([&] { (void)separated_urdf(text, "robots.urdf", "top"); }, ""),
      HasSubstr("robots.urdf: has no robot 'top'"));
}

TEST(JoinedUrdf, SeparatesWhatWasCalibrated) {
  const std::string text = joined_urdf(two_robots());
  const Robot robot = parse_urdf(text, "robots.urdf");
  const std::string patched =
      patch_urdf(text, "robots.urdf", robot, {{"right_elbow", 0.02, {}}}, OffsetStyle::rising);
  EXPECT_THAT(separated_urdf(patched, "calibrated.urdf", "right"), HasSubstr("rising=\"0.02\""));
  EXPECT_THAT(separated_urdf(patched, "calibrated.urdf", "left"), Not(HasSubstr("rising")));
  EXPECT_EQ(parse_urdf(separated_urdf(patched, "c.urdf", "right"), "c.urdf").name(), "arm");
}

TEST(JoinedUrdf, AnyOtherUrdfWasNotJoined) {
  EXPECT_THAT(joined_robots(kArmUrdf, "arm.urdf"), IsEmpty());
  std::string torso = joined_urdf(two_robots());
  for (std::size_t at; (at = torso.find("\"world\"")) != std::string::npos;) {
    torso.replace(at, 7, "\"torso\"");
  }
  EXPECT_THAT(joined_robots(torso, "torso.urdf"), IsEmpty());
}

TEST(JoinedUrdf, NamesARobotThatCannotBe) {
  const auto refusal = [](const std::string& left, const std::string& right) {
    std::vector<RobotPart> parts = two_robots();
    parts[0].name = left;
    parts[1].name = right;
    return test::thrown<InputError>([&] { (void)joined_urdf(parts); }, "");
  };
  EXPECT_THAT(refusal("left", "left"), HasSubstr("two robots are called 'left'"));
  EXPECT_THAT(refusal("arm", "arm_2"), HasSubstr("robot 'arm_2' would begin like those of 'arm'"));
  EXPECT_THAT(refusal("world", "b"), HasSubstr("'world' cannot be the name of a robot"));
  EXPECT_THAT(refusal("a b", "b"), HasSubstr("'a b' cannot be the name of a robot"));
  std::vector<RobotPart> parts = two_robots();
  parts[1].text = "<robot name='x'><link name='a'/><joint";
  EXPECT_THAT(test::thrown<InputError>([&] { (void)joined_urdf(parts); }, ""),
              HasSubstr("right.urdf"));
}

}  // namespace
}  // namespace kinecal
