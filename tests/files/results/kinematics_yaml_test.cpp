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

/// Two arms of UR on one base.
Robot two_ur() {
  std::vector<Joint> joints;
  for (const std::string arm : {"left_", "right_"}) {
    const Robot one = ur(arm);
    for (Joint joint : one.joints()) {
      if (joint.type == JointType::fixed) joint.name = arm + joint.name;
      joint.parent = joint.parent == "l0" ? "base" : arm + joint.parent;
      joint.child = arm + joint.child;
      joints.push_back(joint);
    }
  }
  return Robot("two", joints);
}

TEST(KinematicsYaml, EachOfTwoArmsOfUrHasAFile) {
  const std::string existing = with_hash(kinematics_yaml(ur(), {}, "", "k.yaml"), "calib_7");
  EXPECT_THAT(refusal(two_ur(), existing),
              AllOf(HasSubstr("k.yaml: is a calibration of UR"),
                    HasSubstr("several arms: give left_=FILE, right_=FILE for each")));
  const std::string left = kinematics_yaml(two_ur(), patches("left_"), existing, "k.yaml", "left_");
  EXPECT_EQ(left, with_hash(kinematics_yaml(ur(), patches(), "", "k.yaml"), "calib_7"));
  EXPECT_EQ(kinematics_yaml(two_ur(), patches("left_"), existing, "k.yaml", "right_"), existing)
      << "nothing is known of the right arm";
  EXPECT_EQ(kinematics_difference(two_ur(), left, "k.yaml", "right_").substr(0, 8), "shoulder");
  EXPECT_EQ(kinematics_difference(two_ur(), existing, "k.yaml", "right_"), "");
  EXPECT_THROW((void)kinematics_yaml(two_ur(), {}, existing, "k.yaml", "middle_"), InputError);
}

// ---- Franka

/// An arm of seven joints and a flange, with the names of Franka.
Robot franka(const std::string& prefix) {
  std::vector<Joint> joints;
  for (int i = 1; i <= 8; ++i) {
    Joint joint{prefix + "joint" + std::to_string(i),
                i == 8 ? JointType::fixed : JointType::revolute, prefix + std::to_string(i - 1),
                prefix + std::to_string(i)};
    if (i == 1) joint.parent = "base";
    joint.origin = {rotation_from_rpy({0.1 * i, 0.0, 0.0}), {0.0, 0.1, 0.333}};
    joint.axis = {0.0, 0.0, 1.0};
    joints.push_back(joint);
  }
  return Robot("fr3", joints);
}

std::string franka_file(double roll_of_joint_3 = 0.3) {
  std::string text;
  for (int i = 1; i <= 8; ++i) {
    text += "joint" + std::to_string(i) +
            ":\n  kinematic:\n    x: 0\n    y: 0.1\n    z: 0.333\n    roll: " +
            std::to_string(i == 3 ? roll_of_joint_3 : 0.1 * i) + "\n    pitch: -0\n    yaw: 0\n";
  }
  return text;
}

TEST(KinematicsYaml, AFileOfFrankaKeepsItsForm) {
  const Robot robot = franka("fr3_");
  const std::vector<JointPatch> moved = {{"fr3_joint4", 0.01, {}}};
  const std::string text = kinematics_yaml(robot, moved, franka_file(), "k.yaml");
  EXPECT_THAT(
      text, AllOf(HasSubstr("\njoint1:\n  kinematic:\n    x: 0.0\n    y: 0.1\n"),
                  HasSubstr("\njoint8:\n"), Not(HasSubstr("fr3_")), Not(HasSubstr("kinematics:"))));
  const YAML::Node of = YAML::Load(text)["joint4"]["kinematic"];
  const Matrix3<double> expected =
      rotation_from_rpy({0.4, 0.0, 0.0}) * exp(Vector3<double>(0.0, 0.0, 0.01));
  const Vector3<double> rpy(of["roll"].as<double>(), of["pitch"].as<double>(),
                            of["yaw"].as<double>());
  EXPECT_LE((rotation_from_rpy(rpy) - expected).norm(), kSamePose);
  EXPECT_EQ(kinematics_yaml(robot, moved, text, "k.yaml"), text) << "as it reads its own";
}

TEST(KinematicsYaml, AFileOfFrankaIsNotReplacedByNominalNumbersOrAnotherRobot) {
  EXPECT_EQ(kinematics_difference(franka("fr3_"), franka_file(), "k.yaml"), "");
  EXPECT_EQ(kinematics_difference(franka("fr3_"), franka_file(0.302), "k.yaml"),
            "joint3 by 0.11 deg");
  EXPECT_THAT(refusal(ur(), franka_file()),
              HasSubstr("k.yaml: is a file of Franka, but the robot has no joint 'joint1'"));
  EXPECT_THAT(refusal(franka("fr3_"), franka_file() + "  inertia: {mass: 1}\n"),
              HasSubstr("k.yaml:65: 'inertia' is no origin of a joint and would be lost"));
}

TEST(KinematicsYaml, ZerosAreAListInTheUnitThatIsAskedFor) {
  const std::vector<JointPatch> zeros = {{"elbow_joint", -0.5 * 3.141592653589793, {}}};
  const YAML::Node radians = YAML::Load(zeros_yaml(ur(), zeros, false)),
                   degrees = YAML::Load(zeros_yaml(ur(), zeros, true));
  EXPECT_NEAR(radians["elbow_joint"].as<double>(), -1.5707963267948966, 1e-15);
  EXPECT_NEAR(degrees["elbow_joint"].as<double>(), -90.0, 1e-12);
  EXPECT_EQ(degrees["wrist_3_joint"].as<double>(), 0.0);
  EXPECT_EQ(degrees.size(), 6u) << "a flange has no zero";
  EXPECT_THAT(zeros_yaml(ur(), zeros, true), HasSubstr("# Units: degrees"));
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
