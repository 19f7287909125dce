#include "kinecal/geometry/least_norm.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

constexpr double kRounding = 1e-14;

TEST(LeastNorm, FitsMoreRowsThanColumns) {
  const Eigen::MatrixXd a = (Eigen::MatrixXd(3, 1) << 1.0, 1.0, 2.0).finished();
  const Eigen::MatrixXd b = (Eigen::MatrixXd(3, 2) << 1.0, 0.0, 4.0, 0.0, 5.0, 3.0).finished();
  const Eigen::RowVector2d expected(2.5, 1.0);  // a.b / a.a
  EXPECT_LT((detail::least_norm_solution(a, b) - expected).norm(), kRounding);
}

TEST(LeastNorm, SharesWhatOneRowLeavesUndetermined) {
  const Eigen::MatrixXd a = (Eigen::MatrixXd(2, 3) << 1.0, 1.0, 0.0, 2.0, 2.0, 0.0).finished();
  const Eigen::MatrixXd b = Eigen::Vector2d(2.0, 4.0);
  const Eigen::Vector3d expected(1.0, 1.0, 0.0);
  EXPECT_LT((detail::least_norm_solution(a, b) - expected).norm(), kRounding);
}

TEST(LeastNorm, OfNothingIsZero) {
  const Eigen::MatrixXd none =
      detail::least_norm_solution(Eigen::MatrixXd(3, 0), Eigen::MatrixXd::Identity(3, 3));
  EXPECT_EQ(none.rows(), 0);
  EXPECT_EQ(none.cols(), 3);
  EXPECT_TRUE(
      detail::least_norm_solution(Eigen::MatrixXd(0, 2), Eigen::MatrixXd(0, 1)).isZero(0.0));
}

TEST(LeastNorm, OfTheIdentityIsThePseudoInverse) {
  const Eigen::MatrixXd singular = Eigen::Vector3d(4.0, 0.0, 0.5).asDiagonal();
  const Eigen::Matrix3d expected = Eigen::Vector3d(0.25, 0.0, 2.0).asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_LT((detail::least_norm_solution(singular, identity) - expected).norm(), kRounding);
}

}  // namespace
}  // namespace kinecal
