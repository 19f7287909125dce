#include "kinecal/kinematics/pose_batch.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/robots.hpp"

namespace kinecal {
namespace {

constexpr double kRoundings = 1e-13;  // of a chain of metres: twenty products of numbers below 2

std::vector<double> random_numbers(std::size_t count, double below) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-below, below);
  std::vector<double> numbers(count);
  for (double& x : numbers) x = number(random);
  return numbers;
}

TEST(PoseBatch, IsForwardKinematicsOfEachRow) {
  const Robot robot = test::mobile_manipulator();
  const RuntimeChain chain = make_chain(robot, "hand", "camera_optical_frame");
  const std::vector<std::string> names = joint_names(chain);
  const ChainOfColumns of = make_chain_of_columns(robot, "hand", "camera_optical_frame", names);
  for (const std::size_t rows : {1u, 3u, 8u, 21u}) {  // whole packets and parts of them
    const std::size_t columns = names.size();
    const std::vector<double> q = random_numbers(rows * columns, 3.0);
    std::vector<double> poses(16 * rows), with_jacobians(16 * rows), jacobians(6 * rows * columns);
    forward_kinematics(of, q, poses);
    forward_kinematics(of, q, with_jacobians, jacobians);
    for (std::size_t row = 0; row < rows; ++row) {
      const Eigen::Map<const Eigen::VectorXd> at(&q[row * columns],
                                                 static_cast<Eigen::Index>(columns));
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, static_cast<Eigen::Index>(columns));
      const Pose<double> pose = geometric_jacobian(chain, at, jacobian);
      Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
      matrix.topLeftCorner<3, 3>() = pose.rotation;
      matrix.topRightCorner<3, 1>() = pose.translation;
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      EXPECT_TRUE(Eigen::Map<const RowMajor>(&poses[16 * row], 4, 4).isApprox(matrix, kRoundings));
      EXPECT_TRUE(
          Eigen::Map<const RowMajor>(&with_jacobians[16 * row], 4, 4).isApprox(matrix, kRoundings));
      EXPECT_TRUE(Eigen::Map<const RowMajor>(&jacobians[6 * columns * row], 6,
                                             static_cast<Eigen::Index>(columns))
                      .isApprox(jacobian, kRoundings));
    }
  }
}

Robot with_a_mimic_joint() {
  Joint finger{.name = "finger", .type = JointType::prismatic, .parent = "hand", .child = "left"};
  Joint other{.name = "other", .type = JointType::prismatic, .parent = "left", .child = "right"};
  other.mimic = Mimic{"finger", -0.5, 0.1};
  return {"gripper", {finger, other}};
}

TEST(PoseBatch, MovesMimicJointsByTheColumnThatDrivesThem) {
  const ChainOfColumns of =
      make_chain_of_columns(with_a_mimic_joint(), "hand", "right", {"elsewhere", "finger"});
  std::vector<double> poses(16), jacobians(12);
  forward_kinematics(of, std::vector<double>{9.0, 0.2}, poses, jacobians);
  EXPECT_DOUBLE_EQ(poses[3], 0.2 - 0.5 * 0.2 + 0.1);
  EXPECT_EQ(jacobians[0], 0.0) << "a joint that is not in the chain";
  EXPECT_DOUBLE_EQ(jacobians[1], 0.5);
}

TEST(PoseBatch, JointsWithoutAColumnStayAtZero) {
  const ChainOfColumns of = make_chain_of_columns(with_a_mimic_joint(), "hand", "right", {});
  std::vector<double> poses(16);
  forward_kinematics(of, {}, poses);
  EXPECT_DOUBLE_EQ(poses[3], 0.1);
}

TEST(PoseBatch, RefusesSizesThatDoNotGoTogether) {
  const ChainOfColumns of =
      make_chain_of_columns(with_a_mimic_joint(), "hand", "right", {"finger"});
  std::vector<double> poses(32);
  EXPECT_THROW(forward_kinematics(of, std::vector<double>(3), poses), std::invalid_argument);
  std::vector<double> jacobians(6);
  EXPECT_THROW(forward_kinematics(of, std::vector<double>(2), poses, jacobians),
               std::invalid_argument);
  EXPECT_THROW((void)make_chain_of_columns(with_a_mimic_joint(), "hand", "rihgt", {}), RobotError);
}

}  // namespace
}  // namespace kinecal
