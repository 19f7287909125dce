#include "kinecal/kinematics/walk.hpp"

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "support/oracle.hpp"
#include "support/robots.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

constexpr double kRoundingOfTwists = 1e-14;  // a dozen products of numbers of size one

const std::set<std::string> kNone;
const std::set<std::string> kCorrected = {"shoulder_lift", "elbow_mount",  "wrist",
                                          "head_tilt",     "camera_joint", "head_pan"};

/// A sample with random positions of all joints that are not driven by others.
Sample random_sample(const Robot& robot, unsigned seed) {
  test::RandomPositions positions(seed);
  Sample sample;
  for (const Joint& joint : robot.joints()) {
    if (joint.mimic) continue;
    sample.joint_names.push_back(joint.name);
    sample.joint_positions.push_back(positions(joint.name));
  }
  return sample;
}

/// An offset of each joint and a frame of each joint in kCorrected.
ParameterTable parameters_of(const Robot& robot) {
  ParameterTable table;
  for (const Joint& joint : robot.joints()) {
    if (!joint.mimic) table.add({.name = joint.name});
    if (!kCorrected.contains(joint.name)) continue;
    for (const auto axis : kFrameAxes) table.add({.name = parameter_name(joint.name, axis)});
  }
  return table;
}

double distance(const Pose<double>& a, const Pose<double>& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm();
}

const std::vector<std::pair<std::string, std::string>> kWays = {
    {"base_link", "hand"},     {"base_link", "camera_optical_frame"},
    {"hand", "base_link"},     {"hand", "camera_optical_frame"},
    {"finger_right", "torso"}, {"camera_optical_frame", "counterweight"},
    {"forearm", "forearm"},    {"finger_left", "finger_right"},
};

TEST(Walk, MatchesTheDefinitionBetweenAnyTwoLinks) {
  const Robot robot = test::mobile_manipulator();
  const ParameterTable table = parameters_of(robot);
  for (const auto& way : kWays) {
    const std::string base = way.first, tip = way.second;  // clang 14 captures no bindings
    for (unsigned seed = 0; seed < 5; ++seed) {
      const Sample sample = random_sample(robot, seed);
      const auto position_of = [&](const std::string& joint) { return *sample.position(joint); };
      std::mt19937 random(seed);
      std::normal_distribution<double> normal(0.0, 0.3);
      std::vector<double> zero(static_cast<std::size_t>(table.size()), 0.0), values = zero;
      for (double& value : values) value = normal(random);
      const auto expected = [&](const std::vector<double>& at) -> Pose<double> {
        const test::OraclePose<double> pose =
            test::oracle_pose(robot, base, tip, "", sample, test::OracleValues<double>(table, at));
        return {pose.r, pose.t};
      };
      SCOPED_TRACE(base + " -> " + tip);
      for (const auto& corrected : {kNone, kCorrected}) {
        const RuntimeChain chain = make_chain(robot, base, tip, corrected);
        EXPECT_LE(distance(forward_kinematics(chain, position_of), expected(zero)),
                  kRoundingOfTwists);
      }
      const RuntimeChain chain = make_chain(robot, base, tip, kCorrected);
      const auto corrections =
          corrections_for(chain_parameters(chain, table), std::span<const double>(values));
      EXPECT_LE(distance(forward_kinematics(chain, position_of, corrections), expected(values)),
                kRoundingOfTwists);
    }
  }
}

TEST(Walk, CorrectionStandsBetweenOriginAndMotionAndOffsetAddsToThePosition) {
  const Robot robot = test::mobile_manipulator();
  const RuntimeChain chain = make_chain(robot, "upper_arm", "forearm", {"elbow"});
  Corrections<double> corrections(chain.joints.size());
  const Vector3<double> t(0.01, -0.02, 0.03), w(0.1, -0.2, 0.3);
  corrections[0].set_frame(t, w);
  corrections[0].offset = make_joint_state(0.25);
  const Joint& elbow = robot.joint("elbow");
  const Pose<double> motion{exp(Vector3<double>(elbow.axis * (0.7 + 0.25))), {0, 0, 0}};
  const Pose<double> expected =
      robot.joint("elbow_mount").origin * elbow.origin * Pose<double>{exp(w), t} * motion;
  const auto position_of = [](const std::string&) { return 0.7; };
  EXPECT_LE(distance(forward_kinematics(chain, position_of, corrections), expected),
            kRoundingOfTwists);
}

TEST(Walk, ReversedChainIsTheInverseAlsoWithCorrections) {
  const Robot robot = test::mobile_manipulator();
  const RuntimeChain there = make_chain(robot, "base_link", "hand", kCorrected);
  const RuntimeChain back = make_chain(robot, "hand", "base_link", kCorrected);
  ASSERT_EQ(there.joints.size(), back.joints.size());
  Corrections<double> corrections(there.joints.size());
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const double x = 0.1 * static_cast<double>(i + 1);
    if (there.joints[i].corrected) corrections[i].set_frame({x, -x, 2 * x}, {-x, x, 0.5 * x});
    corrections[i].offset = make_joint_state(0.3 * x);
  }
  Corrections<double> reversed(corrections.rbegin(), corrections.rend());
  test::RandomPositions positions(4);
  const auto position_of = [&](const std::string& joint) { return positions(joint); };
  const Pose<double> product = forward_kinematics(there, position_of, corrections) *
                               forward_kinematics(back, position_of, reversed);
  EXPECT_LE(distance(product, {}), kRoundingOfTwists);
}

// Axes of the frame: only two columns turn about them.

/// A joint about or along one axis between two origins that turn, and a sibling to walk back from.
Robot one_joint(JointType type, const Vector3<double>& axis) {
  using enum JointType;
  return Robot("one", {{"mount", fixed, "base", "plate", test::origin({1, 2, 3}, {0.3, -0.2, 0.5})},
                       {"joint", type, "plate", "moved",
                        test::origin({0.1, -0.2, 0.3}, {-0.4, 0.1, 0.2}), axis},
                       {"tool", fixed, "moved", "tip", test::origin({0.2, 0, 0.1}, {0, 0.7, 0})}});
}

struct AxisCase {
  JointType type;
  Vector3<double> axis;
  bool reversed, corrected;
};

std::vector<AxisCase> axis_cases() {
  std::vector<AxisCase> cases;
  using enum JointType;
  for (const JointType type : {revolute, continuous, prismatic}) {
    for (int k = 0; k < 3; ++k) {
      for (const double sign : {1.0, -1.0}) {
        for (const bool reversed : {false, true}) {
          for (const bool corrected : {false, true}) {
            cases.push_back({type, sign * Vector3<double>::Unit(k), reversed, corrected});
          }
        }
      }
    }
  }
  return cases;
}

/// The chain of a case, offset and correction that are not zero.
struct AxisChain {
  RuntimeChain chain;
  Corrections<double> corrections;

  explicit AxisChain(const AxisCase& c)
      : chain(make_chain(one_joint(c.type, c.axis), c.reversed ? "tip" : "base",
                         c.reversed ? "base" : "tip",
                         c.corrected ? std::set<std::string>{"joint"} : kNone)),
        corrections(chain.joints.size()) {
    corrections[0].offset = make_joint_state(0.2);
    if (c.corrected) corrections[0].set_frame({0.01, 0.02, -0.03}, {0.1, -0.3, 0.2});
  }
  [[nodiscard]] Pose<double> pose(double position) const {
    return forward_kinematics(
        chain, [&](const std::string&) { return position; }, corrections);
  }
};

TEST(Walk, AboutAndAlongTheAxesOfTheFrameMatchesTheDefinition) {
  for (const AxisCase& c : axis_cases()) {
    const AxisChain of_case(c);
    ASSERT_EQ(of_case.chain.joints.size(), 1u);
    ASSERT_GE(of_case.chain.joints[0].principal, 0);
    ASSERT_EQ(of_case.chain.joints[0].reversed, c.reversed);
    const Robot robot = one_joint(c.type, c.axis);
    for (const double q : {-3.1, -0.7, 0.0, 1e-8, 0.4, 2.9}) {
      Pose<double> motion;
      if (c.type == JointType::prismatic) {
        motion.translation = c.axis * (q + 0.2);
      } else {
        motion.rotation = exp(Vector3<double>(c.axis * (q + 0.2)));
      }
      const Pose<double> there = robot.joint("mount").origin * robot.joint("joint").origin *
                                 of_case.corrections[0].frame * motion * robot.joint("tool").origin;
      EXPECT_LE(distance(of_case.pose(q), c.reversed ? there.inverse() : there), kRoundingOfTwists)
          << to_string(c.type) << " " << c.axis.transpose() << (c.reversed ? " reversed" : "");
    }
  }
}

/// Twists of a chain, a column for the offset and six for the correction.
std::vector<std::pair<int, Twist<double>>> twists_of(const AxisChain& of_case, double position) {
  std::vector<JointIndices> columns(1);
  columns[0].offset = 0;
  columns[0].gain = -0.5;
  if (of_case.chain.joints[0].corrected) columns[0].frame = {1, 2, 3, 4, 5, 6};
  ChainTwists<double> twists;
  const TwistColumns order = twist_columns(of_case.chain, columns);
  order.resize(twists);
  TwistWalker<double> walker{columns, twists};
  const auto motions =
      measured_joint_states(of_case.chain, [&](const std::string&) { return position; });
  walk(of_case.chain, std::span<const JointState<double>>(motions),
       std::span<const JointCorrection<double>>(of_case.corrections), walker);
  EXPECT_LE(distance(walker.walker.pose, of_case.pose(position)), 0.0);
  return by_column(twists, order);
}

TEST(Walk, AboutAndAlongTheAxesOfTheFrameIsAsAboutAnyAxis) {
  for (const AxisCase& c : axis_cases()) {
    AxisChain any(c);
    const AxisChain of_frame = any;
    any.chain.joints[0].principal = -1;
    for (const double q : {-3.1, 0.0, 0.4}) {
      EXPECT_LE(distance(any.pose(q), of_frame.pose(q)), kRoundingOfTwists)
          << to_string(c.type) << " " << c.axis.transpose() << (c.reversed ? " reversed" : "");
      const auto expected = twists_of(any, q), found = twists_of(of_frame, q);
      ASSERT_EQ(found.size(), c.corrected ? 7u : 1u);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].first, expected[i].first);
        EXPECT_LE((found[i].second.linear - expected[i].second.linear).norm(), kRoundingOfTwists);
        EXPECT_LE((found[i].second.angular - expected[i].second.angular).norm(), kRoundingOfTwists);
      }
    }
  }
}

TEST(Walk, DistinguishesTheAxesOfTheFrameFromAllOthers) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(principal_axis(Vector3<double>::Unit(k)), k);
    EXPECT_EQ(principal_axis(-Vector3<double>::Unit(k)), k);
  }
  EXPECT_EQ(principal_axis({-0.0, 1.0, -0.0}), 1);
  EXPECT_EQ(principal_axis({0.0, 0.6, 0.8}), -1);
  EXPECT_EQ(principal_axis({1e-17, 0.0, 1.0}), -1);
}

/// The minimal walker of CONCEPTS.md.
struct Counter {
  int moved = 0;
  void fixed(const Pose<double>&) {}
  void correct(std::size_t, const ChainJoint&, const JointCorrection<double>&) {}
  void move(std::size_t, const ChainJoint&, const JointState<double>&) { ++moved; }
};
static_assert(Walker<Counter, double>);

TEST(Walk, CallsAnyWalkerForEachMotion) {
  const RuntimeChain chain = make_chain(test::mobile_manipulator(), "base_link", "hand");
  const std::vector<JointState<double>> motions(chain.joints.size());
  const Corrections<double> corrections(chain.joints.size());
  Counter counter;
  walk(chain, std::span<const JointState<double>>(motions),
       std::span<const JointCorrection<double>>(corrections), counter);
  EXPECT_EQ(counter.moved, 5);
}

TEST(Chain, FoldsFixedJointsThatNobodyCorrects) {
  const Robot robot = test::mobile_manipulator();
  EXPECT_EQ(make_chain(robot, "base_link", "hand").joints.size(), 5u);
  EXPECT_EQ(make_chain(robot, "base_link", "hand", {"elbow_mount"}).joints.size(), 6u);
}

TEST(Chain, NamesTheNearestLinkForAMisspeltOne) {
  const Robot robot = test::mobile_manipulator();
  EXPECT_EQ(test::thrown<RobotError>([&] { (void)make_chain(robot, "base_link", "fourarm"); }),
            "no link 'fourarm' in robot 'mobile_manipulator'; did you mean 'forearm'?");
}

TEST(Chain, RefusesPlanarJointsByName) {
  const Robot robot("r", {{"turn", JointType::revolute, "base", "hand", {}},
                          {"loose", JointType::planar, "base", "ball", {}}});
  EXPECT_THAT(test::thrown<RobotError>([&] { (void)make_chain(robot, "hand", "ball"); }),
              testing::HasSubstr("joint 'loose' between 'hand' and 'ball' is planar"));
}

TEST(Chain, RefusesLinksThatAreNotConnected) {
  const Robot robot(
      "two", {{"a", JointType::fixed, "l0", "l1", {}}, {"b", JointType::fixed, "m0", "m1", {}}});
  EXPECT_THROW((void)make_chain(robot, "l1", "m1"), RobotError);
}

TEST(Robot, RefusesMimicInACircleAndUnknownSources) {
  using enum JointType;
  const Vector3<double> z(0, 0, 1);
  EXPECT_THROW(Robot("r", {{"a", revolute, "l0", "l1", {}, z, Mimic{"b"}},
                           {"b", revolute, "l1", "l2", {}, z, Mimic{"a"}}}),
               RobotError);
  EXPECT_THROW(Robot("r", {{"a", revolute, "l0", "l1", {}, z, Mimic{"c"}}}), RobotError);
  EXPECT_THROW(Robot("r", {{"a", revolute, "l0", "l1", {}, {0, 0, 0}}}), RobotError);
}

// Twists against automatic differentiation of the whole walk.

constexpr int kMaxParameters = 48;
using Wide = ceres::Jet<double, kMaxParameters>;

/// One parameter for each offset and frame axis of the chain, in the order of the chain.
std::vector<JointIndices> all_free(const RuntimeChain& chain, int& count) {
  std::vector<JointIndices> indices;
  std::map<std::string, int> by_joint;
  count = 0;
  for (const ChainJoint& joint : chain.joints) {
    JointIndices& of = indices.emplace_back();
    if (moves(joint.type)) {
      of.gain = joint.drive.multiplier;
      const auto [it, is_new] = by_joint.try_emplace(joint.drive.joint, count);
      count += is_new ? 1 : 0;
      of.offset = it->second;
    }
    if (joint.corrected) {
      for (int& axis : of.frame) axis = count++;
    }
  }
  return indices;
}

template <class S>
Corrections<S> fill(const std::vector<JointIndices>& indices, const std::vector<S>& x) {
  const auto at = [&](int i) { return x[static_cast<std::size_t>(i)]; };
  Corrections<S> corrections(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const auto& f = indices[i].frame;
    if (indices[i].offset >= 0) {
      corrections[i].offset = make_joint_state(S(at(indices[i].offset) * indices[i].gain));
    }
    if (f[0] >= 0) {
      corrections[i].set_frame({at(f[0]), at(f[1]), at(f[2])}, {at(f[3]), at(f[4]), at(f[5])});
    }
  }
  return corrections;
}

/// Size of the corrections: zero, tiny, random, and rotation vectors near pi.
class Twists : public testing::TestWithParam<double> {};

TEST_P(Twists, AgreeWithAutodiffThroughTheWholeWalk) {
  const Robot robot = test::mobile_manipulator();
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const auto& [base, tip] : kWays) {
    const RuntimeChain chain = make_chain(robot, base, tip, kCorrected);
    int count = 0;
    const std::vector<JointIndices> indices = all_free(chain, count);
    ASSERT_LE(count, kMaxParameters);
    std::vector<double> x(static_cast<std::size_t>(count));
    for (double& v : x) v = GetParam() * normal(random);
    if (GetParam() > 3.0) {  // near pi: a random axis, the angle just below it
      for (const JointIndices& joint : indices) {
        if (joint.frame[3] < 0) continue;
        const Vector3<double> w =
            Vector3<double>(normal(random), normal(random), normal(random)).normalized() *
            (std::numbers::pi - 1e-6);
        for (int k = 0; k < 3; ++k) x[static_cast<std::size_t>(joint.frame[3] + k)] = w(k);
      }
    }
    std::vector<Wide> jets;
    for (int i = 0; i < count; ++i) jets.emplace_back(x[static_cast<std::size_t>(i)], i);

    test::RandomPositions positions(9);
    const auto position_of = [&](const std::string& joint) { return positions(joint); };
    const Vector3<double> p(0.3, -0.2, 0.5);
    const Vector3<Wide> expected = forward_kinematics(chain, position_of, fill(indices, jets)) * p;

    ChainTwists<double> twists;
    twist_columns(chain, indices).resize(twists);
    TwistWalker<double> walker{indices, twists};
    const auto motions = measured_joint_states(chain, position_of);
    const Corrections<double> corrections = fill(indices, x);
    walk(chain, std::span<const JointState<double>>(motions),
         std::span<const JointCorrection<double>>(corrections), walker);
    const Vector3<double> p_base = walker.walker.pose * p;
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, kMaxParameters);
    for (const auto& [column, twist] : by_column(twists, twist_columns(chain, indices))) {
      jacobian.col(column) += twist.velocity(p_base);
    }
    Eigen::MatrixXd oracle(3, kMaxParameters);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(p_base(i), expected(i).a, kRoundingOfTwists * (1 + std::abs(expected(i).a)));
      oracle.row(i) = expected(i).v.transpose();
    }
    // Products of a dozen rotations and translations of up to 3 GetParam() metres.
    EXPECT_LE((jacobian - oracle).norm(), 1e-13 * (1.0 + oracle.norm()))
        << base << " -> " << tip << "\ntwists\n"
        << jacobian << "\njets\n"
        << oracle;
  }
}

INSTANTIATE_TEST_SUITE_P(AtZeroTinyRandomAndNearPi, Twists,
                         testing::Values(0.0, 1e-8, 0.1, 1.0, 3.1));

}  // namespace
}  // namespace kinecal
