#include "kinecal/files/results/kinematics_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Two ways to the same pose; angles are taken out of a matrix and put back.
constexpr double kSamePose = 1e-9;

const std::vector<std::string> kUrNames = {"shoulder_pan_joint", "shoulder_lift_joint",
                                           "elbow_joint",        "wrist_1_joint",
                                           "wrist_2_joint",      "wrist_3_joint"};

/// An arm of six joints, as UR's descriptions have it.
Robot ur(const std::string& prefix = "", const Vector3<double>& axis = {0.0, 0.0, 1.0}) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < kUrNames.size(); ++i) {
    Joint joint{prefix + kUrNames[i], JointType::revolute, "l" + std::to_string(i),
                "l" + std::to_string(i + 1)};
    joint.origin = {rotation_from_rpy({0.3 * static_cast<double>(i), 0.1, -0.2}), {0.1, 0.2, 0.3}};
    joint.axis = axis;
    joints.push_back(joint);
  }
  joints.push_back({"flange", JointType::fixed, "l6", "flange"});
  return Robot("ur", joints);
}

std::vector<JointPatch> patches(const std::string& prefix = "") {
  JointPatch lift{prefix + "shoulder_lift_joint",
                  0.02,
                  {exp(Vector3<double>(0.01, 0.02, 0.03)), {1e-3, 2e-3, 3e-3}}};
  return {{prefix + "shoulder_pan_joint", -1.5, {}}, lift, {prefix + "wrist_3_joint", 0.01, {}}};
}

/// The robot with the origins that a file has for its joints, in their order.
Robot robot_of(const std::string& text, const Robot& nominal) {
  const YAML::Node file = YAML::Load(text)["kinematics"];
  std::vector<Joint> joints = nominal.joints();
  auto joint = joints.begin();
  for (const auto& entry : file) {
    if (!entry.second.IsMap()) continue;
    const auto number = [&](const char* key) { return entry.second[key].as<double>(); };
    joint->origin = {rotation_from_rpy({number("roll"), number("pitch"), number("yaw")}),
                     {number("x"), number("y"), number("z")}};
    ++joint;
  }
  return Robot("of file", joints);
}

TEST(KinematicsYaml, ReadingsOnTheOriginsOfTheFileGiveTheCalibratedPose) {
  const Robot robot = ur();
  const Robot written = robot_of(kinematics_yaml(robot, patches(), "", "k.yaml"), robot);
  const RuntimeChain chain = make_chain(robot, "l0", "flange", {"shoulder_lift_joint"});
  const auto reading = [](const std::string& joint) {
    return 0.1 * static_cast<double>(joint.size());
  };
  Corrections<double> corrections(chain.joints.size());
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    for (const JointPatch& patch : patches()) {
      if (patch.joint != chain.joints[i].name) continue;
      corrections[i].offset = make_joint_state(patch.offset);
      corrections[i].frame = patch.correction;
    }
  }
  const Pose<double> expected = forward_kinematics(chain, reading, corrections);
  const Pose<double> found = forward_kinematics(make_chain(written, "l0", "flange"), reading);
  EXPECT_LE((found.rotation - expected.rotation).norm(), kSamePose);
  EXPECT_LE((found.translation - expected.translation).norm(), kSamePose);
}

std::string with_hash(std::string text, const std::string& hash) {
  const std::size_t at = text.find("  hash:");
  return text.replace(at, std::string::npos, "  hash: " + hash + "\n");
}

TEST(KinematicsYaml, ArmsOfUrHaveItsNamesAndKeepTheHashOfTheFile) {
  const std::string fresh = kinematics_yaml(ur(), patches(), "", "k.yaml");
  EXPECT_THAT(fresh, AllOf(HasSubstr("\nkinematics:\n  shoulder:\n    x: 0.1\n"),
                           HasSubstr("  upper_arm:"), HasSubstr("  wrist_3:"),
                           HasSubstr("  hash: calib_unknown"), Not(HasSubstr("flange"))));
  const std::string existing = with_hash(fresh, "calib_123");
  const std::string again = kinematics_yaml(ur("left_"), patches("left_"), existing, "k.yaml");
  EXPECT_THAT(again, HasSubstr("  hash: calib_123\n"));
  EXPECT_EQ(kinematics_yaml(ur("left_"), patches("left_"), again, "k.yaml"), again);
}

TEST(KinematicsYaml, OtherRobotsHaveTheNamesOfTheirJoints) {
  const Robot old = ur("", {0.0, 1.0, 0.0});  // an older description: its origins are others
  const std::string text = kinematics_yaml(old, {}, "", "k.yaml");
  EXPECT_THAT(text, AllOf(HasSubstr("  shoulder_pan_joint:\n"), HasSubstr("  flange:\n"),
                          Not(HasSubstr("hash"))));
  EXPECT_EQ(kinematics_yaml(old, {}, text, "k.yaml"), text);
}

std::string refusal(const Robot& robot, const std::string& existing) {
  try {
    return "accepted: " + kinematics_yaml(robot, {}, existing, "k.yaml");
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(KinematicsYaml, AFileThatIsNoneIsNotReplaced) {
  EXPECT_THAT(refusal(ur(), "joints: [a]\n"),
              StartsWith("k.yaml: exists and has no 'kinematics:'"));
  EXPECT_THAT(refusal(ur(), "a: [\n"), StartsWith("k.yaml:"));
}

TEST(KinematicsYaml, AFileOfUrIsNotReplacedByAnotherRobot) {
  const std::string existing = kinematics_yaml(ur(), {}, "", "k.yaml");
  EXPECT_THAT(refusal(ur("", {0.0, 1.0, 0.0}), existing),
              AllOf(StartsWith("k.yaml: is a calibration of UR, but"), HasSubstr("about z")));
  EXPECT_THAT(refusal(Robot("r", {{"j", JointType::fixed, "a", "b"}}), existing),
              HasSubstr("has no joint 'shoulder_pan_joint'"));
}

TEST(KinematicsYaml, NamesTheJointsOfAUrdfThatWasNotMadeWithTheFile) {
  const std::string existing = kinematics_yaml(ur(), {}, "", "k.yaml");
  EXPECT_EQ(kinematics_difference(ur(), existing, "k.yaml"), "");
  const std::vector<JointPatch> moved = {
      {"wrist_1_joint", 0.0, {Matrix3<double>::Identity(), {3e-4, 0.0, 0.0}}}};
  EXPECT_EQ(kinematics_difference(ur(), kinematics_yaml(ur(), moved, "", "k.yaml"), "k.yaml"),
            "wrist_1 by 0.3 mm");
  EXPECT_THAT(kinematics_difference(ur(), kinematics_yaml(ur(), patches(), "", "k.yaml"), "k.yaml"),
              HasSubstr("upper_arm by"));
  std::string broken = existing;
  broken.replace(broken.find("    z:"), 6, "    w:");
  EXPECT_THROW((void)kinematics_difference(ur(), broken, "k.yaml"), InputError);
}

}  // namespace
}  // namespace kinecal
