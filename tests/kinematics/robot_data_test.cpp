#include "kinecal/kinematics/robot_data.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "support/same_joint.hpp"

namespace kinecal {
namespace {

using enum JointType;

/// A sliding torso, a wheel that mimics it and a camera, with all that a joint can have.
struct Lift {
  static constexpr std::string_view kName = "lift";
  static constexpr std::array<JointData, 3> kJoints = {{
      {.name = "slide",
       .type = prismatic,
       .parent = "base",
       .child = "torso",
       .origin = {.rotation = {0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0},
                  .translation = {0.1, -0.0, 0.3}},
       .axis = {0.0, 0.6, 0.8},
       .limits = LimitsData{-0.5, 1.5}},
      {.name = "wheel",
       .type = continuous,
       .parent = "torso",
       .child = "rim",
       .mimic = MimicData{"slide", -2.0, 0.25}},
      {.name = "mount", .parent = "torso", .child = "camera"},
  }};
};
static_assert(RobotData<Lift>);

struct OneLink {
  static constexpr std::string_view kName = "one_link";
  static constexpr std::array<JointData, 0> kJoints = {};
};
static_assert(RobotData<OneLink>);

struct ChildrenFirst {
  static constexpr std::string_view kName = "children_first";
  static constexpr std::array<JointData, 2> kJoints = {{
      {.name = "elbow", .parent = "upper", .child = "lower"},
      {.name = "shoulder", .parent = "base", .child = "upper"},
  }};
};
static_assert(!RobotData<ChildrenFirst> && !parents_first(ChildrenFirst::kJoints));

struct BelowItself {
  static constexpr std::string_view kName = "below_itself";
  static constexpr std::array<JointData, 1> kJoints = {
      {{.name = "j", .parent = "a", .child = "a"}}};
};
struct TwoRoots {
  static constexpr std::string_view kName = "two_roots";
  static constexpr std::array<JointData, 2> kJoints = {{
      {.name = "left", .parent = "a", .child = "b"},
      {.name = "right", .parent = "c", .child = "d"},
  }};
};
struct OfNumbers {
  static constexpr std::string_view kName = "of_numbers";
  static constexpr std::array<int, 1> kJoints = {1};
};
static_assert(!RobotData<BelowItself> && !RobotData<TwoRoots> && !RobotData<OfNumbers>);
static_assert(!RobotData<Robot> && !RobotData<int>);

TEST(RobotData, ItsRobotAtRunTimeHasTheSameJoints) {
  const Robot robot = robot_from<Lift>();
  EXPECT_EQ(robot.name(), "lift");
  ASSERT_EQ(robot.joints().size(), Lift::kJoints.size());
  for (std::size_t i = 0; i < Lift::kJoints.size(); ++i) {
    EXPECT_TRUE(test::same_joint(Lift::kJoints[i], robot.joints()[i]));
  }
}

TEST(RobotData, ARotationIsRowMajor) {
  const Pose<double> pose = pose_from({{1, 2, 3, 4, 5, 6, 7, 8, 9}, {10, 11, 12}});
  EXPECT_EQ(pose.rotation(0, 2), 3.0);
  EXPECT_EQ(pose.rotation(2, 0), 7.0);
  EXPECT_EQ(pose.translation, Vector3<double>(10, 11, 12));
}

TEST(RobotData, ARobotWithoutJointsIsOne) {
  EXPECT_TRUE(robot_from<OneLink>().joints().empty());
}

TEST(RobotData, AnAxisOfLengthOneStaysTheSameBitByBit) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int i = 0; i < 10000; ++i) {
    Joint joint{"j", revolute, "a", "b", {}, {number(random), number(random), number(random)}};
    const Vector3<double> once = Robot("r", {joint}).joints().front().axis;
    joint.axis = once;
    const Vector3<double> twice = Robot("r", {joint}).joints().front().axis;
    ASSERT_EQ(once, twice) << once.transpose() << ", length " << once.norm();
  }
}

}  // namespace
}  // namespace kinecal
