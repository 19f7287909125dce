#include "kinecal/kinematics/forward_kinematics.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <random>

#include "kinecal/geometry/jet.hpp"
#include "support/every_robot.hpp"
#include "support/paths.hpp"
#include "support/static_robot.hpp"

namespace kinecal {
namespace {

constexpr double kRoundingOfChains = 1e-13;

KDL::Vector to_kdl(const Vector3<double>& v) {
  return {v.x(), v.y(), v.z()};
}
KDL::Frame to_kdl(const Pose<double>& pose) {
  const Matrix3<double>& r = pose.rotation;
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          to_kdl(pose.translation)};
}

/// The joints from a link down to another one, as segments of KDL: nothing is folded.
KDL::Chain kdl_chain(const Robot& robot, const std::string& base, const std::string& tip) {
  std::vector<const Joint*> way;
  for (std::string link = tip; link != base; link = way.back()->parent) {
    way.push_back(robot.parent_joint(link));
  }
  KDL::Chain chain;
  for (auto joint = way.rbegin(); joint != way.rend(); ++joint) {
    const KDL::Frame origin = to_kdl((*joint)->origin);
    const KDL::Vector axis = origin.M * to_kdl((*joint)->axis);
    const KDL::Joint moved =
        !moves((*joint)->type)
            ? KDL::Joint((*joint)->name, KDL::Joint::Fixed)
            : KDL::Joint((*joint)->name, origin.p, axis,
                         turns((*joint)->type) ? KDL::Joint::RotAxis : KDL::Joint::TransAxis);
    chain.addSegment(KDL::Segment((*joint)->name, moved, origin));
  }
  return chain;
}

/// The link of a robot that has the most moving joints above it.
std::string last_link(const Robot& robot) {
  std::string deepest;
  std::ptrdiff_t most = -1;
  for (const Joint& joint : robot.joints()) {
    const auto way = joints_to_root(robot, joint.child);
    const auto moving =
        std::count_if(way.begin(), way.end(), [](const Joint* j) { return moves(j->type); });
    if (moving > most) {
      most = moving;
      deepest = joint.child;
    }
  }
  return deepest;
}

Eigen::VectorXd random_positions(Eigen::Index joints, std::mt19937& random) {
  std::uniform_real_distribution<double> position(-3.0, 3.0);
  return Eigen::VectorXd::NullaryExpr(joints, [&] { return position(random); });
}

class RobotsOfUrdfs : public testing::TestWithParam<test::NamedUrdf> {};

TEST_P(RobotsOfUrdfs, AgreeWithKdl) {
  const Robot robot = read_urdf(GetParam().file.string());
  const std::string tip = last_link(robot), base = joints_to_root(robot, tip).back()->parent;
  const RuntimeChain chain = make_chain(robot, base, tip);
  const KDL::Chain of_kdl = kdl_chain(robot, base, tip);
  const auto joints = static_cast<Eigen::Index>(chain.joints.size());
  ASSERT_EQ(of_kdl.getNrOfJoints(), chain.joints.size());
  ASSERT_GE(joints, 1);
  KDL::ChainFkSolverPos_recursive forward(of_kdl);
  KDL::ChainJntToJacSolver differential(of_kdl);
  std::mt19937 random(3);
  for (int n = 0; n < 20; ++n) {
    const Eigen::VectorXd q = random_positions(joints, random);
    KDL::JntArray positions(of_kdl.getNrOfJoints());
    positions.data = q;
    KDL::Frame frame;
    KDL::Jacobian expected(of_kdl.getNrOfJoints());
    ASSERT_EQ(forward.JntToCart(positions, frame), 0);
    ASSERT_EQ(differential.JntToJac(positions, expected), 0);

    const Pose<double> pose = forward_kinematics(chain, q);
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, joints);
    const Pose<double> same = geometric_jacobian(chain, q, jacobian);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(pose.translation(i), frame.p(i), kRoundingOfChains);
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(pose.rotation(i, j), frame.M(i, j), kRoundingOfChains);
    }
    EXPECT_EQ(same.translation, pose.translation);
    EXPECT_LE((jacobian - expected.data).cwiseAbs().maxCoeff(), kRoundingOfChains);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryRobot, RobotsOfUrdfs, testing::ValuesIn(test::every_robot()),
                         [](const auto& param) { return param.param.name; });

TEST(GeometricJacobian, OfAChainThatGoesUpAndDownIsThatOfJets) {
  const Robot robot = read_urdf(test::source_folder() + "/examples/robots/fetch/fetch.urdf");
  const RuntimeChain chain = make_chain(robot, "wrist_roll_link", "head_tilt_link");
  const auto joints = static_cast<Eigen::Index>(chain.joints.size());
  ASSERT_TRUE(chain.joints.front().reversed);
  std::mt19937 random(4);
  const Eigen::VectorXd q = random_positions(joints, random);
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, joints);
  const Matrix3<double> rotation = geometric_jacobian(chain, q, jacobian).rotation;
  for (Eigen::Index i = 0; i < joints; ++i) {
    using J = Jet<double, 1>;
    Eigen::Matrix<J, Eigen::Dynamic, 1> jets(joints);
    for (Eigen::Index k = 0; k < joints; ++k) jets(k) = k == i ? J(q(k), 0) : J(q(k));
    const Pose<J> pose = forward_kinematics(chain, jets);
    Matrix3<double> by_q;
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(pose.translation(r).v(0), jacobian(r, i), kRoundingOfChains);
      for (int c = 0; c < 3; ++c) by_q(r, c) = pose.rotation(r, c).v(0);
    }
    const Matrix3<double> spin = by_q * rotation.transpose();  // [w]x
    EXPECT_NEAR(spin(2, 1), jacobian(3, i), kRoundingOfChains);
    EXPECT_NEAR(spin(0, 2), jacobian(4, i), kRoundingOfChains);
    EXPECT_NEAR(spin(1, 0), jacobian(5, i), kRoundingOfChains);
  }
}

TEST(GeometricJacobian, OfAChainThatTheCompilerKnowsIsTheSame) {
  using Hand = Chain<test::StaticRobot, "base", "tip">;
  const RuntimeChain chain = make_chain(robot_from<test::StaticRobot>(), "base", "tip");
  EXPECT_EQ(joint_names(Hand{}), (std::vector<std::string>{"lift", "pan", "elbow", "wrist"}));
  EXPECT_EQ(joint_names(chain), joint_names(Hand{}));
  const Eigen::Vector4d q(0.1, 0.2, -0.3, 0.4);
  Eigen::Matrix<double, 6, 4> expected;
  const Pose<double> pose = geometric_jacobian(chain, q, expected);
  const Eigen::Matrix<double, 6, 4> jacobian = geometric_jacobian(Hand{}, q);
  EXPECT_LE((jacobian - expected).cwiseAbs().maxCoeff(), kRoundingOfChains);
  EXPECT_LE((forward_kinematics(Hand{}, q).translation - pose.translation).norm(),
            kRoundingOfChains);
}

TEST(ForwardKinematics, RefusesOtherSizesThanTheChains) {
  const RuntimeChain chain = make_chain(robot_from<test::StaticRobot>(), "base", "tip");
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, 3);
  EXPECT_THROW((void)forward_kinematics(chain, Eigen::VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_THROW(geometric_jacobian(chain, Eigen::VectorXd::Zero(4), jacobian),
               std::invalid_argument);
}

TEST(ForwardKinematics, TakesTheJetsOfCeres) {
  using J = ceres::Jet<double, 4>;
  const RuntimeChain chain = make_chain(robot_from<test::StaticRobot>(), "base", "tip");
  Eigen::Matrix<J, 4, 1> q;
  for (int i = 0; i < 4; ++i) q(i) = J(0.1 * (i + 1), i);
  Eigen::Matrix<double, 6, 4> jacobian;
  geometric_jacobian(chain, Eigen::Vector4d(0.1 * Eigen::Vector4d(1, 2, 3, 4)), jacobian);
  const Pose<J> pose = forward_kinematics(chain, q);
  for (int r = 0; r < 3; ++r) {
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(pose.translation(r).v(i), jacobian(r, i), kRoundingOfChains);
  }
}

}  // namespace
}  // namespace kinecal
