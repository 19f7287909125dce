// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/search/parameter_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// 100 rows of ten poses, by seven columns: three random ones, the sum of the first and the second, zeros, the third with
/// a hundred-thousandth of another one, and one too small to be determined.
ParameterSearch search() {
  constexpr Eigen::Index kRows = 100, kColumns = 7;
  constexpr int kPoses = 10;
  SeededRandom random(1);
  const auto noise = [&] {
    Eigen::VectorXd column(kRows);
    for (double& value : column) value = random.normal();
    return column;
  };
  LinearFit fit;
  fit.jacobian.setZero(kRows, kColumns);
  for (const Eigen::Index c : {0, 1, 2, 6}) fit.jacobian.col(c) = noise();
  fit.jacobian.col(3) = fit.jacobian.col(0) + fit.jacobian.col(1);
  fit.jacobian.col(5) = fit.jacobian.col(2) + 1e-5 * noise();
  fit.jacobian.col(6) *= 1e-6;
  fit.residual = noise();
  fit.loss = Eigen::VectorXd::Ones(kRows);
  fit.prior_gradient = Eigen::VectorXd::Zero(kColumns);
  fit.prior_hessian = Eigen::MatrixXd::Zero(kColumns, kColumns);
  SearchPoses poses;
  for (int pose = 0; pose < kPoses; ++pose) {
    fit.blocks.push_back({0, pose, 10 * pose, 10});
    poses.pose.push_back(pose);
    poses.fold.push_back(pose % 5);
  }
  return {fit, poses, Eigen::VectorXd::Ones(kColumns)};
}

TEST(ParameterSearch, AColumnIsExplainedByOthersOrZero) {
  const ParameterSearch of = search();
  EXPECT_TRUE(of.explains({0, 1}, 3));
  EXPECT_FALSE(of.explains({0}, 3));
  EXPECT_TRUE(of.explains({}, 4)) << "zeros";
  EXPECT_TRUE(of.explains({2}, 5)) << "the rest is too small a share of it";
  EXPECT_FALSE(of.explains({0, 1, 2}, 6));
}

TEST(ParameterSearch, OfDependentColumnsTheFirstAreKept) {
  EXPECT_THAT(search().independent({3, 0, 1, 2, 4, 5, 6}), ElementsAre(3, 0, 2, 6));
}

TEST(ParameterSearch, KeepsOfAFrameWhatSamplesDetermine) {
  const ParameterSearch of = search();
  EXPECT_THAT(of.determined({0}, {1, 2, 3, 4, 5, 6}), ElementsAre(1, 2));
  EXPECT_THAT(of.determined({0, 1}, {3}), IsEmpty());
  EXPECT_THAT(of.determined({}, {6}), IsEmpty())
      << "its deviation is larger than what is plausible";
}

}  // namespace
}  // namespace kinecal
