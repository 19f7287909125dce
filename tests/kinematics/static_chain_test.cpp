#include "kinecal/kinematics/static_chain.hpp"

#include <gtest/gtest.h>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/kinematics/twist_walker.hpp"
#include "support/static_robot.hpp"

namespace kinecal {
namespace {

using test::StaticRobot;
using Arm = Chain<StaticRobot, "base", "tip">;
using Frames = Names<"pan", "mount", "camera_joint", "weight">;

static_assert(Arm::kSize == 4 && Arm::kFirstMotion == 0);
static_assert(Chain<StaticRobot, "base", "base">::kSize == 0);
static_assert(Chain<StaticRobot, "head", "camera_frame">::kSize == 0, "all of it is folded");
static_assert(Chain<StaticRobot, "head", "camera_frame", Frames>::kSize == 1);
static_assert(Chain<StaticRobot, "head", "camera_frame", Frames>::kFirstMotion == 1);
static_assert(Chain<StaticRobot, "shoulder", "tip", Frames>::kFirstMotion == 1);
static_assert(Chain<StaticRobot, "base", "tip", Names<>, "board">::kSize == 5);
static_assert(Arm::kJoints[1].axis.principal() == 2 && Arm::kJoints[2].axis.principal() == -1);
static_assert(Arm::kTail.translation == std::array{0.1, 0.0, 0.0});

/// Joint positions that both kinds of chain get.
struct Positions {
  [[nodiscard]] double operator()(const std::string& joint) const {
    double position = 0.1;
    for (const char c : joint) position = 0.37 * position + 0.01 * (c - 'h');
    return position;
  }
};

/// Corrections that are nowhere zero.
Corrections<double> some_corrections(std::size_t joints) {
  Corrections<double> corrections(joints);
  for (std::size_t i = 0; i < joints; ++i) {
    const double n = 0.01 * static_cast<double>(i + 1);
    corrections[i].offset = make_joint_state(n);
    corrections[i].set_frame({n, -2 * n, 0.5 * n}, {-n, 0.3 * n, 2 * n});
  }
  return corrections;
}

double difference(const Pose<double>& a, const Pose<double>& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm();
}

/// A chain that the compiler knows against the same chain at run time: pose and twists.
template <class C>
void expect_the_same_walk(const std::set<std::string>& frames) {
  constexpr double kRounding = 4e-15;  // folded in another order, fused multiply-adds
  RuntimeChain chain =
      make_chain(robot_from<StaticRobot>(), std::string(C::kBase), std::string(C::kTip), frames);
  if (!C::kVirtual.empty()) chain = with_virtual_frame(chain, std::string(C::kVirtual));
  SCOPED_TRACE(chain.base + " to " + chain.tip);
  ASSERT_EQ(chain.joints.size(), C::kSize);
  for (std::size_t i = 0; i < C::kSize; ++i) {
    EXPECT_EQ(chain.joints[i].name, C::kJoints[i].name);
    EXPECT_EQ(chain.joints[i].corrected, C::kJoints[i].corrected);
    EXPECT_EQ(chain.joints[i].reversed, C::kJoints[i].reversed);
    EXPECT_EQ(chain.joints[i].principal, C::kJoints[i].axis.principal());
    EXPECT_EQ(chain.joints[i].drive.joint, C::kJoints[i].drive.joint);
    EXPECT_DOUBLE_EQ(chain.joints[i].drive.multiplier, C::kJoints[i].drive.multiplier);
    EXPECT_DOUBLE_EQ(chain.joints[i].drive.offset, C::kJoints[i].drive.offset);
  }
  EXPECT_LE(
      difference(forward_kinematics(chain, Positions{}), forward_kinematics(C{}, Positions{})),
      kRounding);

  const Corrections<double> corrections = some_corrections(C::kSize);
  std::vector<JointIndices> columns(C::kSize);
  int next = 0;
  for (std::size_t i = 0; i < C::kSize; ++i) {
    columns[i].offset = i == 1 ? -1 : next++;
    columns[i].gain = chain.joints[i].drive.multiplier;
    for (int& axis : columns[i].frame) axis = next++;
  }
  const std::span<const JointCorrection<double>> all(corrections);
  const auto motions = measured_joint_states(chain, Positions{});
  const auto walked = [&](const auto& any_chain) {
    const TwistColumns order = twist_columns(chain, columns);
    ChainTwists<double> twists;
    order.resize(twists);
    TwistWalker<double> walker{columns, twists};
    walk(any_chain, std::span<const JointState<double>>(motions), all, walker);
    return std::pair(walker.walker.pose, by_column(twists, order));
  };
  const auto [expected_pose, expected] = walked(chain);
  const auto [pose, found] = walked(C{});
  EXPECT_LE(difference(pose, expected_pose), kRounding);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].first, expected[i].first);
    EXPECT_LE((found[i].second.linear - expected[i].second.linear).norm(), kRounding);
    EXPECT_LE((found[i].second.angular - expected[i].second.angular).norm(), kRounding);
  }
}

TEST(StaticChain, IsWalkedAsTheSameChainAtRunTime) {
  expect_the_same_walk<Arm>({});
  expect_the_same_walk<Chain<StaticRobot, "torso", "hand">>({});
  expect_the_same_walk<Chain<StaticRobot, "base", "finger_right">>({});
  expect_the_same_walk<Chain<StaticRobot, "plate", "counterweight">>({});
  expect_the_same_walk<Chain<StaticRobot, "base", "camera_frame">>({});
  expect_the_same_walk<Chain<StaticRobot, "head", "camera_frame">>({});
  expect_the_same_walk<Chain<StaticRobot, "tip", "tip">>({});
}

TEST(StaticChain, HasTheSameCorrectionsAsAtRunTime) {
  const std::set<std::string> frames = {"pan", "mount", "camera_joint", "weight"};
  expect_the_same_walk<Chain<StaticRobot, "base", "tip", Frames>>(frames);
  expect_the_same_walk<Chain<StaticRobot, "base", "camera_frame", Frames>>(frames);
  expect_the_same_walk<Chain<StaticRobot, "shoulder", "counterweight", Frames>>(frames);
  expect_the_same_walk<Chain<StaticRobot, "head", "camera_frame", Frames>>(frames);
  expect_the_same_walk<Chain<StaticRobot, "base", "tip", Frames, "board">>(frames);
  expect_the_same_walk<Chain<StaticRobot, "base", "base", Names<>, "tracker">>({});
}

TEST(StaticChain, LeadsBetweenAnyTwoLinks) {
  const std::set<std::string> frames = {"pan", "mount", "camera_joint", "weight"};
  expect_the_same_walk<Chain<StaticRobot, "tip", "base">>({});
  expect_the_same_walk<Chain<StaticRobot, "camera_frame", "tip">>({});
  expect_the_same_walk<Chain<StaticRobot, "tip", "camera_frame", Frames>>(frames);
  expect_the_same_walk<Chain<StaticRobot, "counterweight", "camera_frame", Frames, "board">>(
      frames);
  expect_the_same_walk<Chain<StaticRobot, "finger_right", "hand">>({});
}

struct Shift {
  static constexpr PoseData kPose = test::shifted(0.0, -2.0, 1.0);
};
struct Turn {
  static constexpr PoseData kPose = {{0, 0, 1, -1, 0, 0, 0, -1, 0}, {0.5, 0.0, 0.0}};
};

TEST(StaticPose, SkipsWhatIsZeroOrOne) {
  const Pose<double> start = pose_from(test::turned_about(1, {1, 2, 3}) * test::turned_about(0));
  for (int which = 0; which < 2; ++which) {
    Pose<double> found = start;
    if (which == 0) {
      multiply_by_constant<Shift>(found);
    } else {
      multiply_by_constant<Turn>(found);
    }
    EXPECT_LE(difference(found, start * pose_from(which == 0 ? Shift::kPose : Turn::kPose)), 1e-15);
  }
}

}  // namespace
}  // namespace kinecal
