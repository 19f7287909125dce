#include "kinecal/geometry/eigenpairs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kinecal {
namespace {

TEST(Eigenpairs, AreAscendingAndComposeTheMatrix) {
  Eigen::MatrixXd matrix(3, 3);
  matrix << 2.0, -1.0, 0.0,  //
      -1.0, 2.0, -1.0,       //
      0.0, -1.0, 2.0;
  const detail::Eigenpairs pairs = detail::eigenpairs(matrix);
  constexpr double kRounding = 1e-14;
  const Eigen::Vector3d expected(2.0 - std::sqrt(2.0), 2.0, 2.0 + std::sqrt(2.0));
  EXPECT_LT((pairs.values - expected).norm(), kRounding);
  const Eigen::MatrixXd composed =
      pairs.vectors * pairs.values.asDiagonal() * pairs.vectors.transpose();
  EXPECT_LT((composed - matrix).norm(), kRounding);
}

TEST(Eigenpairs, ReadTheLowerTriangleOnly) {
  Eigen::MatrixXd matrix(2, 2);
  matrix << 1.0, 7.0,  //
      0.0, 3.0;
  EXPECT_LT((detail::eigenpairs(matrix).values - Eigen::Vector2d(1.0, 3.0)).norm(), 1e-14);
}

}  // namespace
}  // namespace kinecal
