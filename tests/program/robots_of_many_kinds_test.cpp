// Humanoids large and small, a quadruped, mobile manipulators and an arm on a platform: init, simulate, plan, detect and calibrate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "support/run_program.hpp"

namespace kinecal {
namespace {

using test::Outcome;
using testing::HasSubstr;

/// Lines of a robot, one a joint:
///   name type parent child, x y z, roll pitch yaw, x y z of the axis, limits, mimic JOINT MULTIPLIER
std::string urdf_of(const std::string& name, const std::string& lines) {
  std::ostringstream urdf;
  std::vector<std::string> links;
  urdf << "<robot name=\"" << name << "\">\n";
  std::istringstream all(lines);
  for (std::string line; std::getline(all, line);) {
    std::istringstream words(line);
    std::string joint, type, parent, child, xyz, rpy, axis, limits, mimic;
    words >> joint >> type >> parent >> child;
    const auto numbers = [&](int count) {
      std::string text, word;
      for (int i = 0; i < count && words >> word; ++i) text += (i > 0 ? " " : "") + word;
      return text;
    };
    xyz = numbers(3);
    rpy = numbers(3);
    axis = numbers(3);
    if (type != "continuous" && type != "fixed") {
      const std::string lower = numbers(1), upper = numbers(1);
      limits =
          "<limit lower=\"" + lower + "\" upper=\"" + upper + "\" effort=\"9\" velocity=\"2\"/>";
    }
    if (std::string word; words >> word && word == "mimic") {
      const std::string of = numbers(1), times = numbers(1);
      mimic = "<mimic joint=\"" + of + "\" multiplier=\"" + times + "\"/>";
    }
    if (links.empty()) links.push_back(parent);
    links.push_back(child);
    urdf << "<joint name=\"" << joint << "\" type=\"" << type << "\"><parent link=\"" << parent
         << "\"/><child link=\"" << child << "\"/><origin xyz=\"" << xyz << "\" rpy=\""
         << (rpy.empty() ? "0 0 0" : rpy) << "\"/>"
         << (axis.empty() ? "" : "<axis xyz=\"" + axis + "\"/>") << limits << mimic << "</joint>\n";
  }
  for (const std::string& link : links) urdf << "<link name=\"" << link << "\"/>\n";
  urdf << "</robot>\n";
  return urdf.str();
}

std::string camera_on(const std::string& link, const std::string& xyz) {
  return "camera_joint fixed " + link + " camera_link " + xyz +
         "\ncamera_optical_joint fixed camera_link camera_optical_frame 0 0 0 -1.5707963 0 "
         "-1.5707963\n";
}

/// Joints of a leg that hangs below a link.
std::string leg(const std::string& of, const std::string& parent, const std::string& at,
                const std::string& thigh, const std::string& shin) {
  return of + "_hip_yaw revolute " + parent + " " + of + "_hip " + at + " 0 0 0 0 0 1 -0.6 0.6\n" +
         of + "_hip_roll revolute " + of + "_hip " + of + "_hip2 0 0 0 0 0 0 1 0 0 -0.4 0.4\n" +
         of + "_hip_pitch revolute " + of + "_hip2 " + of + "_thigh 0 0 0 0 0 0 0 1 0 -1.5 0.5\n" +
         of + "_knee revolute " + of + "_thigh " + of + "_shin 0 0 -" + thigh +
         " 0 0 0 0 1 0 -0.1 2.1\n" + of + "_ankle revolute " + of + "_shin " + of + "_foot 0 0 -" +
         shin + " 0 0 0 0 1 0 -1.1 0.9\n" + of + "_sole_joint fixed " + of + "_foot " + of +
         "_sole 0 0 -0.05\n";
}

/// A tall humanoid: a waist, seven joints in each arm, the root is the pelvis.
std::string tall_humanoid() {
  std::string lines =
      "torso_1 revolute base_link torso_1_link 0 0 0.07 0 0 0 0 0 1 -1.2 1.2\n"
      "torso_2 revolute torso_1_link torso_2_link 0 0 0 0 0 0 0 1 0 -0.2 0.7\n"
      "head_1 revolute torso_2_link head_1_link 0.02 0 0.32 0 0 0 0 1 0 -0.2 0.75\n"
      "head_2 revolute head_1_link head_2_link 0 0 0 0 0 0 0 0 1 -1.3 1.3\n" +
      camera_on("head_2_link", "0.08 0 0.12");
  for (const std::string s : {"l", "r"}) {
    const bool left = s == "l";
    const auto joint = [&](int n, const std::string& rest) {
      const std::string child = s + "_arm_" + std::to_string(n) + "_link";
      const std::string parent =
          n == 1 ? "torso_2_link" : s + "_arm_" + std::to_string(n - 1) + "_link";
      lines +=
          s + "_arm_" + std::to_string(n) + " revolute " + parent + " " + child + " " + rest + "\n";
    };
    joint(1, std::string("0 ") + (left ? "" : "-") + "0.16 0.23 0 0 0 0 0 1 -1.5 1.5");
    joint(2, "0 0 0 0 0 0 1 0 0 -2.8 2.8");
    joint(3, "0 0 0 0 0 0 0 0 1 -2.4 2.4");
    joint(4, "0.02 0 -0.27 0 0 0 0 1 0 -2.2 0");
    joint(5, "-0.02 0 -0.26 0 0 0 0 0 1 -2.5 2.5");
    joint(6, "0 0 0 0 0 0 1 0 0 -1.3 1.3");
    joint(7, "0 0 0 0 0 0 0 1 0 -0.6 0.6");
    lines += s + "_gripper_joint fixed " + s + "_arm_7_link " + s + "_gripper 0 0 -0.1\n" +
             leg(s, "base_link", left ? "0 0.085 -0.1" : "0 -0.085 -0.1", "0.38", "0.33");
  }
  return lines;
}

/// A mobile manipulator with casters, a lift, and an arm with two joints that turn without end.
std::string manipulator_with_casters() {
  std::string lines =
      "footprint fixed base_footprint base_link 0 0 0.05\n"
      "front_caster continuous base_link front_caster_link 0.22 0 0.03 0 0 0 0 0 1\n"
      "front_wheel continuous front_caster_link front_wheel_link 0 0.05 0 0 0 0 0 1 0\n"
      "torso_lift prismatic base_link torso -0.05 0 0.74 0 0 0 0 0 1 0.01 0.32\n"
      "head_pan revolute torso pan_link -0.02 0 0.38 0 0 0 0 0 1 -2.9 2.9\n"
      "head_tilt revolute pan_link tilt_link 0.07 0 0 0 0 0 0 1 0 -0.4 1.4\n" +
      camera_on("tilt_link", "0.05 0 0.09");
  return lines +
         "shoulder_pan revolute torso shoulder 0 0.19 0 0 0 0 0 0 1 -0.6 2.2\n"
         "shoulder_lift revolute shoulder lift_link 0.1 0 0 0 0 0 0 1 0 -0.5 1.3\n"
         "upper_arm_roll revolute lift_link upper_arm 0 0 0 0 0 0 1 0 0 -0.7 3.8\n"
         "elbow_flex revolute upper_arm elbow 0.4 0 0 0 0 0 0 1 0 -2.3 0\n"
         "forearm_roll continuous elbow forearm 0 0 0 0 0 0 1 0 0\n"
         "wrist_flex revolute forearm wrist 0.32 0 0 0 0 0 0 1 0 -2.1 0\n"
         "wrist_roll continuous wrist palm 0 0 0 0 0 0 1 0 0\n"
         "gripper_joint prismatic palm slider 0.08 0 0 0 0 0 0 1 0 0 0.09\n"
         "tool_joint fixed palm tool 0.18 0 0\n";
}

/// A lift with a telescope on a mast.
std::string telescope() {
  std::string lines =
      "left_wheel continuous base_link left_wheel_link 0 0.16 0.05 -1.57 0 0 0 0 1\n"
      "mast_joint fixed base_link mast -0.07 0.13 0.03 1.5707963 0 0\n"
      "lift prismatic mast lift_link -0.04 0.6 0 -1.5707963 1.5707963 0 0 0 1 0 1.1\n"
      "arm_joint fixed lift_link arm_4 -0.25 0 0 1.5707963 0 -1.5707963\n";
  for (int i = 3; i >= 0; --i) {
    const std::string n = std::to_string(i), before = std::to_string(i + 1);
    lines += "telescope_" + n + " prismatic arm_" + before + " arm_" + n +
             " 0 0 0.013 0 0 0 0 0 1 0 0.13\n";
  }
  return lines +
         "wrist_yaw revolute arm_0 wrist_1 0.08 -0.03 0 1.5707963 0 0 0 0 -1 -1.75 4\n"
         "wrist_pitch revolute wrist_1 wrist_2 0 -0.02 0.02 1.5707963 0 0 0 0 1 -1.57 0.56\n"
         "wrist_roll revolute wrist_2 wrist_3 -0.02 0 0.02 -1.5707963 0 -1.5707963 0 0 1 -3.1 3.1\n"
         "gripper_joint fixed wrist_3 gripper 0 0 0.1\n"
         "head_joint fixed mast head 0 1.33 0 -1.5707963 -1.5707963 0\n"
         "head_pan revolute head pan_link 0 0.05 0 0 0 0 0 0 1 -3.9 1.5\n"
         "head_tilt revolute pan_link tilt_link 0.03 -0.05 0.05 1.5707963 0 0 0 0 1 -1.53 0.79\n"
         "camera_joint fixed tilt_link camera_link 0.03 0 0.02 1.5707963 0 0\n"
         "camera_optical_joint fixed camera_link camera_optical_frame 0 0 0 -1.5707963 0 "
         "-1.5707963\n";
}

/// A base with odometry, a lift that the head mimics, and an arm of four joints.
std::string manipulator_with_odometry() {
  return "odom_x prismatic odom slide_x 0 0 0 0 0 0 1 0 0 -10 10\n"
         "odom_y prismatic slide_x slide_y 0 0 0 0 0 0 0 1 0 -10 10\n"
         "odom_t continuous slide_y base_link 0 0 0 0 0 0 0 0 1\n"
         "arm_lift prismatic base_link arm_lift_link 0.14 0 0.34 0 0 0 0 0 1 0 0.69\n"
         "arm_flex revolute arm_lift_link arm_flex_link 0.005 0 0 0 0 0 0 -1 0 -2.6 0\n"
         "arm_roll revolute arm_flex_link arm_roll_link 0 0 0.345 0 0 0 0 0 1 -2 3.8\n"
         "wrist_flex revolute arm_roll_link wrist_flex_link 0 0 0.12 0 0 0 0 -1 0 -1.9 1.2\n"
         "wrist_roll revolute wrist_flex_link wrist_roll_link 0 0 0 0 0 0 0 0 1 -1.9 3.6\n"
         "palm_joint fixed wrist_roll_link palm 0.012 0 0.13\n"
         "torso_lift prismatic base_link torso 0 0 0.75 0 0 0 0 0 1 0 0.34 mimic arm_lift 0.5\n"
         "head_pan revolute torso pan_link 0.02 0 0.1 0 0 0 0 0 1 -3.8 1.7\n"
         "head_tilt revolute pan_link tilt_link 0.02 0 0.06 0 0 0 0 -1 0 -1.5 0.5\n" +
         camera_on("tilt_link", "0.07 0 0.09");
}

/// A quadruped whose arm has a camera in its hand.
std::string quadruped_with_arm() {
  return leg("left_front", "body", "0.3 0.11 0", "0.32", "0.34") +
         leg("right_front", "body", "0.3 -0.11 0", "0.32", "0.34") +
         leg("left_hind", "body", "-0.3 0.11 0", "0.32", "0.34") +
         leg("right_hind", "body", "-0.3 -0.11 0", "0.32", "0.34") +
         "arm_1 revolute body arm_1_link 0.29 0 0.19 0 0 0 0 0 1 -2.6 3.1\n"
         "arm_2 revolute arm_1_link arm_2_link 0 0 0 0 0 0 0 1 0 -3.1 0.5\n"
         "arm_3 revolute arm_2_link arm_3_link 0.34 0 0 0 0 0 0 1 0 0 3.1\n"
         "arm_4 revolute arm_3_link arm_4_link 0.4 0 0.07 0 0 0 1 0 0 -2.8 2.8\n"
         "arm_5 revolute arm_4_link arm_5_link 0 0 0 0 0 0 0 1 0 -1.8 1.8\n"
         "arm_6 revolute arm_5_link hand 0.11 0 0 0 0 0 1 0 0 -2.9 2.9\n" +
         camera_on("hand", "0.12 0 0.02");
}

/// Two arms of five joints that hang from shoulders: roll of the shoulder away from the body, an elbow that only bends.
/// @param at       of the left shoulder: x, y and z, metres
/// @param lengths  of the upper arm, the forearm and the hand, metres
std::string arms_of_five(const std::string& torso, const std::array<std::string, 3>& at,
                         const std::array<std::string, 3>& lengths) {
  std::string lines;
  for (const std::string s : {"l", "r"}) {
    const bool left = s == "l";
    const std::string sign = left ? "" : "-";
    lines += s + "_shoulder_pitch revolute " + torso + " " + s + "_shoulder " + at[0] + " " + sign +
             at[1] + " " + at[2] + " 0 0 0 0 1 0 -2.08 2.08\n" + s + "_shoulder_roll revolute " +
             s + "_shoulder " + s + "_biceps 0 0 0 0 0 0 0 0 1 " +
             (left ? "-0.31 1.32" : "-1.32 0.31") + "\n" + s + "_elbow_yaw revolute " + s +
             "_biceps " + s + "_elbow " + lengths[0] + " " + sign +
             "0.015 0 0 0 0 1 0 0 -2.08 2.08\n" + s + "_elbow_roll revolute " + s + "_elbow " + s +
             "_forearm 0 0 0 0 0 0 0 0 1 " + (left ? "-1.54 -0.03" : "0.03 1.54") + "\n" + s +
             "_wrist_yaw revolute " + s + "_forearm " + s + "_wrist " + lengths[1] +
             " 0 0 0 0 0 1 0 0 -1.82 1.82\n" + s + "_hand_joint fixed " + s + "_wrist " + s +
             "_gripper " + lengths[2] + " 0 -0.01\n";
  }
  return lines;
}

/// A humanoid half a metre tall: its hands reach 0.2 m from its head.
std::string small_humanoid() {
  return "head_yaw revolute base_link neck 0 0 0.126 0 0 0 0 0 1 -2.08 2.08\n"
         "head_pitch revolute neck head 0 0 0 0 0 0 0 1 0 -0.67 0.51\n" +
         camera_on("head", "0.059 0 0.064") +
         arms_of_five("base_link", {"0", "0.098", "0.1"}, {"0.105", "0.056", "0.058"}) +
         leg("l", "base_link", "0 0.05 -0.085", "0.1", "0.103") +
         leg("r", "base_link", "0 -0.05 -0.085", "0.1", "0.103");
}

/// A humanoid on wheels, with a knee and a hip.
std::string wheeled_humanoid() {
  return "knee_pitch revolute base_link thigh 0 0 0.334 0 0 0 0 1 0 -0.51 0.51\n"
         "hip_pitch revolute thigh pelvis 0 0 0.268 0 0 0 0 1 0 -1.03 1.03\n"
         "hip_roll revolute pelvis torso 0 0 0.079 0 0 0 1 0 0 -0.51 0.51\n"
         "head_yaw revolute torso neck -0.038 0 0.31 0 0 0 0 0 1 -2.08 2.08\n"
         "head_pitch revolute neck head 0 0 0 0 0 0 0 1 0 -0.7 0.63\n" +
         camera_on("head", "0.087 0 0.154") +
         arms_of_five("torso", {"-0.057", "0.15", "0.227"}, {"0.181", "0.15", "0.07"});
}

/// A lift with a head and one arm of seven joints.
std::string lift_with_head() {
  return "torso_lift prismatic base_link torso -0.06 0 0.79 0 0 0 0 0 1 0 0.35\n"
         "head_1 revolute torso head_1_link 0.18 0 0 0 0 0 0 0 1 -1.24 1.24\n"
         "head_2 revolute head_1_link head_2_link 0.005 0 0.1 0 0 0 0 1 0 -0.72 0.98\n" +
         camera_on("head_2_link", "0.05 0 0.06") +
         "arm_1 revolute torso arm_1_link 0.155 -0.014 -0.151 0 0 -1.57 0 0 1 0.07 2.68\n"
         "arm_2 revolute arm_1_link arm_2_link 0.125 0.02 -0.03 0 0 0 0 -1 0 -1.5 1.02\n"
         "arm_3 revolute arm_2_link arm_3_link 0.09 0 0 0 0 0 1 0 0 -3.46 1.57\n"
         "arm_4 revolute arm_3_link arm_4_link 0.22 0 0.02 0 0 0 0 -1 0 -0.32 2.29\n"
         "arm_5 revolute arm_4_link arm_5_link 0.16 0 -0.02 0 0 0 1 0 0 -2.07 2.07\n"
         "arm_6 revolute arm_5_link arm_6_link 0.15 0 0 0 0 0 0 1 0 -1.39 1.39\n"
         "arm_7 revolute arm_6_link arm_7_link 0 0 0 0 0 0 1 0 0 -2.07 2.07\n"
         "tool_joint fixed arm_7_link tool 0.16 0 0\n";
}

/// A torso on a pedestal with two long arms, and a head that only pans.
std::string two_long_arms() {
  std::string lines = "head_pan revolute base_link head 0.06 0 0.686 0 0 0 0 0 1 -1.39 1.39\n" +
                      camera_on("head", "0.12 0 0.1 0 0.5 0");
  for (const std::string s : {"l", "r"}) {
    const std::string sign = s == "l" ? "" : "-";
    const auto joint = [&](const std::string& name, const std::string& parent,
                           const std::string& rest) {
      lines +=
          s + "_" + name + " revolute " + parent + " " + s + "_" + name + "_link " + rest + "\n";
    };
    joint("s0", "base_link", "0.064 " + sign + "0.259 0.13 0 0 " + sign + "0.785 0 0 1 -1.7 1.7");
    joint("s1", s + "_s0_link", "0.069 0 0.27 0 0 0 0 1 0 -2.14 1.04");
    joint("e0", s + "_s1_link", "0.102 0 0 0 0 0 1 0 0 -3.05 3.05");
    joint("e1", s + "_e0_link", "0.262 0 -0.069 0 0 0 0 1 0 -0.05 2.61");
    joint("w0", s + "_e1_link", "0.104 0 0 0 0 0 1 0 0 -3.05 3.05");
    joint("w1", s + "_w0_link", "0.271 0 -0.01 0 0 0 0 1 0 -1.57 2.09");
    joint("w2", s + "_w1_link", "0.116 0 0 0 0 0 1 0 0 -3.05 3.05");
    lines += s + "_gripper_joint fixed " + s + "_w2_link " + s + "_gripper 0.16 0 0\n";
  }
  return lines;
}

/// Five joints on a low platform, with a camera in the hand.
std::string arm_on_platform() {
  return "arm_1 revolute base_link arm_1_link 0.167 0 0.17 0 0 0 0 0 1 -2.95 2.95\n"
         "arm_2 revolute arm_1_link arm_2_link 0.033 0 0.019 0 0 0 0 1 0 -1.13 1.57\n"
         "arm_3 revolute arm_2_link arm_3_link 0 0 0.155 0 0 0 0 1 0 -2.54 2.54\n"
         "arm_4 revolute arm_3_link arm_4_link 0 0 0.135 0 0 0 0 1 0 -1.78 1.78\n"
         "arm_5 revolute arm_4_link arm_5_link 0 0 0.114 0 0 0 0 0 1 -2.92 2.92\n" +
         camera_on("arm_5_link", "0.05 0 0.04 0 -1.5707963 0");
}

struct Kind {
  std::string name, lines, target, arm;  ///< target and arm of `init`; the arm is proposed first
  int poses = 16;                        ///< of the calibration
};

class RobotsOfManyKinds : public test::ProgramTest, public testing::WithParamInterface<Kind> {};

TEST_P(RobotsOfManyKinds, AreSimulatedPlannedAndCalibrated) {
  const Kind kind = GetParam();
  write("robot.urdf", urdf_of(kind.name, kind.lines));
  const Outcome asked = kinecal("init --urdf robot.urdf --target " + kind.target);
  EXPECT_NE(asked.code, 0);
  if (kind.arm.empty()) {
    EXPECT_THAT(asked.err, testing::Not(HasSubstr("_sole")));
  } else {
    EXPECT_THAT(asked.err,
                testing::AnyOf(HasSubstr("use one of " + kind.arm),
                               HasSubstr("--camera is required")));  // it is the only one
  }
  const std::string arm = kind.arm.empty() ? "" : " --arm " + kind.arm;
  const Outcome init = kinecal("init --urdf robot.urdf --camera camera_optical_frame --target " +
                               kind.target + " --camera-type camera2d" + arm);
  ASSERT_EQ(init.code, 0) << init.err;
  const Outcome made = kinecal("simulate robot.urdf --target apriltag --poses " +
                               std::to_string(kind.poses) + " -o sim");
  ASSERT_EQ(made.code, 0) << made.err;
  const Outcome plan =
      kinecal("plan --urdf robot.urdf --target apriltag --candidates 12 -o p.yaml");
  EXPECT_THAT(plan.code, testing::AnyOf(0, 2)) << plan.err;  // 2: twelve candidates are too few
  const Outcome found = kinecal(
      "detect sim/capture.yaml --images sim/images --poses sim/poses.csv --camera sim/camera.yaml "
      "--frame camera_optical_frame -o samples.yaml");
  ASSERT_EQ(found.code, 0) << found.err;
  const Outcome fitted = kinecal(
      "calibrate --urdf robot.urdf --config sim/calibrate.yaml --samples samples.yaml --output "
      "out");
  EXPECT_EQ(fitted.code, 0) << fitted.err << fitted.out;
  EXPECT_THAT(fitted.out, testing::AnyOf(HasSubstr("good"), HasSubstr("use with care")));
  EXPECT_THAT(fitted.out + fitted.err, testing::Not(HasSubstr("never moves")));
}

INSTANTIATE_TEST_SUITE_P(
    All, RobotsOfManyKinds,
    testing::Values(Kind{"TallHumanoid", tall_humanoid(), "apriltag", "l_gripper"},
                    Kind{"Casters", manipulator_with_casters(), "apriltag", "palm"},
                    Kind{"Telescope", telescope(), "apriltag", "gripper"},
                    Kind{"Odometry", manipulator_with_odometry(), "apriltag", "palm"},
                    Kind{"Quadruped", quadruped_with_arm(), "world_apriltag", ""},
                    Kind{"SmallHumanoid", small_humanoid(), "apriltag", "l_gripper"},
                    Kind{"WheeledHumanoid", wheeled_humanoid(), "apriltag", "l_gripper"},
                    Kind{"LiftWithHead", lift_with_head(), "apriltag", "tool"},
                    Kind{"TwoLongArms", two_long_arms(), "apriltag", "l_gripper", 20},
                    Kind{"ArmOnPlatform", arm_on_platform(), "world_apriltag", ""}),
    [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace kinecal
