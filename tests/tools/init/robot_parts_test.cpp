// The proposals for each robot: the end of the arm that its makers would choose comes first.
#include "kinecal/tools/init/robot_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "support/every_robot.hpp"
#include "support/paths.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

Robot example(const std::string& name) {
  return read_urdf(test::source_folder() + "/examples/" + name + ".urdf");
}

TEST(ProposeArms, FindsTheHandsOfEveryRobot) {
  for (const test::NamedUrdf& urdf : test::every_robot()) {
    EXPECT_THAT(propose_arms(read_urdf(urdf.file.string())), Not(IsEmpty())) << urdf.file;
  }
}

TEST(ProposeArms, NamesNeitherHeadsNorFingersNorCameras) {
  EXPECT_THAT(propose_arms(example("robots/fetch/fetch")),
              ElementsAre("gripper_link", "gripper_led_frame"));
  EXPECT_THAT(propose_arms(example("robots/tiago/tiago")), ElementsAre("arm_chessboard_link"));
  EXPECT_THAT(propose_arms(example("robots/panda/panda")), ElementsAre("panda_hand"));
  EXPECT_THAT(propose_arms(example("mobile_manipulator/mobile_manipulator")),
              ElementsAre("gripper_link"));
  EXPECT_THAT(propose_arms(example("robots/pr2/pr2")),
              ElementsAre("l_gripper_led_frame", "l_gripper_tool_frame", "r_gripper_led_frame",
                          "r_gripper_tool_frame"));
}

/// A robot of joints in a row, each with its type: base, link1, link2, ...
std::vector<Joint> row(const std::vector<std::pair<std::string, JointType>>& joints) {
  std::vector<Joint> all;
  for (const auto& [name, type] : joints) {
    const std::string parent = all.empty() ? "base" : all.back().child;
    all.push_back({name, type, parent, "link" + std::to_string(all.size() + 1), {}});
  }
  return all;
}

TEST(ProposeArms, EndsBeforeTheMotorsOfAGripper) {
  constexpr JointType kTurns = JointType::revolute, kSlides = JointType::prismatic;
  for (const auto& [name, type] :
       {std::pair("gripper_motor_screw_joint", kTurns), std::pair("left_finger_joint", kTurns),
        std::pair("rh_thumb_1", kTurns), std::pair("gripper_joint", kSlides)}) {
    const auto joints = row({{"a", kTurns},
                             {"b", kTurns},
                             {"c", kTurns},
                             {"d", kTurns},
                             {name, type},
                             {"tip_joint", JointType::fixed}});
    EXPECT_THAT(propose_arms(Robot("r", joints)), ElementsAre("link4")) << name;
  }
  auto mimicked = row({{"a", kTurns}, {"b", kTurns}, {"c", kTurns}, {"d", kTurns}, {"e", kTurns}});
  mimicked.push_back({"f", kTurns, "link4", "other", {}});
  mimicked.back().mimic = Mimic{"e", -1.0, 0.0};
  EXPECT_THAT(propose_arms(Robot("r", mimicked)), ElementsAre("link4"));
  const auto wrist = row({{"a", kTurns}, {"b", kTurns}, {"c", kTurns}, {"gripper_roll", kTurns}});
  EXPECT_THAT(propose_arms(Robot("r", wrist)), ElementsAre("link4")) << "a wrist";
}

TEST(ProposeArms, NamesLegsOnlyIfThereIsNothingElse) {
  constexpr JointType kTurns = JointType::revolute;
  std::vector<Joint> joints;
  const auto add_row = [&](const std::vector<std::string>& names) {
    std::string parent = "torso";
    for (const std::string& name : names) {
      joints.push_back({name, kTurns, parent, name + "_link", {}});
      parent = name + "_link";
    }
  };
  add_row({"LHipYaw", "LHipRoll", "LHipPitch", "LKneePitch", "LAnklePitch", "LAnkleRoll"});
  EXPECT_THAT(propose_arms(Robot("r", joints)), ElementsAre("LAnkleRoll_link"));
  add_row({"LShoulderPitch", "LShoulderRoll", "LElbowYaw", "LWristYaw"});
  EXPECT_THAT(propose_arms(Robot("r", joints)), ElementsAre("LWristYaw_link"));
}

TEST(ProposeArms, NamesNoWheels) {
  constexpr JointType kTurns = JointType::continuous;
  EXPECT_THAT(propose_arms(Robot("r", row({{"lift", kTurns},
                                           {"swing", kTurns},
                                           {"caster_rotation", kTurns},
                                           {"wheel", kTurns}}))),
              IsEmpty());
}

TEST(ProposeCameras, NamesTheOpticalFrameOfColourFirst) {
  const auto fetch = propose_cameras(example("robots/fetch/fetch"));
  ASSERT_FALSE(fetch.empty());
  EXPECT_EQ(fetch.front(), "head_camera_rgb_optical_frame");
  EXPECT_EQ(propose_cameras(example("robots/panda/panda")).front(), "camera_color_optical_frame");
  EXPECT_THAT(propose_cameras(example("robots/ur5e/ur5e")), IsEmpty());
}

TEST(ProposeBase, IsTheRootOrTheLinkBelowAFloatingJoint) {
  EXPECT_EQ(propose_base(example("robots/pr2/pr2"), "l_gripper_led_frame"), "base_footprint");
  Joint floating{"world_joint", JointType::floating, "world", "base", {}};
  Joint turning{"turn", JointType::revolute, "base", "tip", {}};
  EXPECT_EQ(propose_base(Robot("r", {floating, turning}), "tip"), "base");
  EXPECT_THROW((void)propose_base(Robot("r", {turning}), "tpi"), RobotError);
}

}  // namespace
}  // namespace kinecal
