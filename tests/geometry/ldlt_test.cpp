#include "kinecal/geometry/ldlt.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

Eigen::MatrixXd definite() {
  Eigen::MatrixXd matrix(2, 2);
  matrix << 4.0, 9.0,  // the upper triangle is not read
      2.0, 3.0;
  return matrix;
}

TEST(Ldlt, SolvesForAVectorAndForColumns) {
  const detail::Ldlt ldlt(definite());
  const Eigen::VectorXd x = ldlt.solve(Eigen::VectorXd(Eigen::Vector2d(8.0, 8.0)));
  EXPECT_LT((x - Eigen::Vector2d(1.0, 2.0)).norm(), 1e-14);
  const Eigen::MatrixXd inverse = ldlt.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(2, 2)));
  const Eigen::Matrix2d expected = (Eigen::Matrix2d() << 3.0, -2.0, -2.0, 4.0).finished() / 8.0;
  EXPECT_LT((inverse - expected).norm(), 1e-14);
}

TEST(Ldlt, LeastPivotIsNegativeOfAnIndefiniteMatrix) {
  EXPECT_NEAR(detail::Ldlt(definite()).least_pivot(), 2.0, 1e-14);
  Eigen::MatrixXd matrix = definite();
  matrix(1, 1) = 0.0;
  EXPECT_NEAR(detail::Ldlt(matrix).least_pivot(), -1.0, 1e-14);
}

TEST(Ldlt, SmallSystemsAreSolvedInPlaceAndMayBeSingular) {
  Eigen::Vector2d x(8.0, 8.0);
  const Eigen::MatrixXd matrix = definite();
  detail::solve_small(matrix.data(), x.data(), 2);
  EXPECT_LT((x - Eigen::Vector2d(1.0, 2.0)).norm(), 1e-14);
  const Eigen::Matrix3d singular = Eigen::Vector3d(0.0, 4.0, 0.0).asDiagonal();
  Eigen::Vector3d y(0.0, 8.0, 0.0);
  detail::solve_small(singular.data(), y.data(), 3);
  EXPECT_EQ(y, Eigen::Vector3d(0.0, 2.0, 0.0));
}

}  // namespace
}  // namespace kinecal
