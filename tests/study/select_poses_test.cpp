#include "kinecal/study/select_poses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal::test {
namespace {

/// Poses that tell something of random combinations of parameters.
PoseCandidates random_poses(int count, int size, std::uint64_t seed) {
  SeededRandom random(seed);
  PoseCandidates candidates;
  for (int i = 0; i < count; ++i) {
    Eigen::MatrixXd rows(3, size);
    const double useful = random.uniform(0.2, 2.0);
    for (double& entry : rows.reshaped()) entry = useful * random.normal();
    candidates.information.push_back(Eigen::MatrixXd(rows.transpose() * rows));
  }
  candidates.goal = Eigen::MatrixXd(Eigen::MatrixXd::Identity(size, size));
  return candidates;
}

constexpr PoseCriterion kAll[] = {PoseCriterion::gripper, PoseCriterion::a, PoseCriterion::d,
                                  PoseCriterion::e};

TEST(SelectPoses, IsAsGoodAsTryingAllSets) {
  for (const PoseCriterion criterion : kAll) {
    double worst = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const PoseCandidates candidates = random_poses(12, 5, seed);
      const PoseSelection selection =
          select_poses(candidates, {.count = 4, .criterion = criterion});
      double least = std::numeric_limits<double>::infinity();
      std::vector<bool> in(12, false);
      std::fill(in.begin(), in.begin() + 4, true);
      do {
        std::vector<int> set;
        for (int i = 0; i < 12; ++i) {
          if (in[static_cast<std::size_t>(i)]) set.push_back(i);
        }
        least = std::min(least, design_value(candidates, set, criterion));
      } while (std::prev_permutation(in.begin(), in.end()));
      const double ours = design_value(candidates, selection.chosen, criterion);
      const double over = criterion == PoseCriterion::d ? ours - least : ours / least - 1.0;
      worst = std::max(worst, over);
    }
    EXPECT_LT(worst, 0.25) << static_cast<int>(criterion);
  }
}

TEST(SelectPoses, IsBetterThanTheBestOfAThousandRandomSets) {
  for (const PoseCriterion criterion : kAll) {
    const PoseCandidates candidates = random_poses(80, 10, 7);
    const PoseSelection selection = select_poses(candidates, {.count = 15, .criterion = criterion});
    const RandomSets random = random_sets(candidates, 15, 1000, criterion);
    EXPECT_LT(design_value(candidates, selection.chosen, criterion), random.values.front());
    EXPECT_EQ(random.values.size(), 1000U);
    EXPECT_DOUBLE_EQ(design_value(candidates, random.best, criterion), random.values.front());
  }
}

TEST(SelectPoses, TheFirstFewAreAGoodSetAndValuesFall) {
  const PoseCandidates candidates = random_poses(60, 8, 3);
  const PoseSelection selection = select_poses(candidates, {.count = 20});
  ASSERT_EQ(selection.chosen.size(), 20U);
  ASSERT_EQ(selection.values.size(), 20U);
  EXPECT_TRUE(std::isinf(selection.values.front()));  // three rows do not determine eight
  for (std::size_t i = 1; i < 20; ++i) EXPECT_LE(selection.values[i], selection.values[i - 1]);
  const std::vector<int> ten(selection.chosen.begin(), selection.chosen.begin() + 10);
  const RandomSets random = random_sets(candidates, 10, 200, PoseCriterion::gripper);
  EXPECT_LT(design_value(candidates, ten, PoseCriterion::gripper), random.values[100]);
}

TEST(SelectPoses, NearDuplicatesAreNotChosen) {
  PoseCandidates candidates = random_poses(20, 4, 5);
  for (int i = 0; i < 20; ++i) candidates.shares.push_back({0.05 * (i / 2), 0.5});  // pairs
  const PoseSelection selection = select_poses(candidates, {.count = 20});
  EXPECT_EQ(selection.chosen.size(), 10U);
  for (const int a : selection.chosen) {
    for (const int b : selection.chosen) EXPECT_TRUE(a == b || a / 2 != b / 2);
  }
}

TEST(SelectPoses, WhatNoPoseDeterminesIsLeftOut) {
  PoseCandidates candidates = random_poses(20, 4, 5), wider = candidates;
  for (PlainMatrix& of : wider.information) {
    Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(5, 5);
    larger.topLeftCorner(4, 4) = of.matrix();
    of = larger;
  }
  wider.goal = Eigen::MatrixXd(Eigen::MatrixXd::Identity(5, 5));
  const PoseSelection selection = select_poses(candidates, {.count = 6});
  const PoseSelection same = select_poses(wider, {.count = 6});
  EXPECT_EQ(selection.chosen, same.chosen);
  EXPECT_NEAR(selection.value, same.value, 1e-9 * selection.value);
}

TEST(SelectPoses, WhatIsKnownBeforeCounts) {
  PoseCandidates candidates = random_poses(30, 6, 11);
  const std::vector<int> nothing;
  EXPECT_TRUE(std::isinf(design_value(candidates, nothing, PoseCriterion::gripper)));
  candidates.before = Eigen::MatrixXd(4.0 * Eigen::MatrixXd::Identity(6, 6));
  EXPECT_NEAR(design_value(candidates, nothing, PoseCriterion::gripper), 6.0 / 4.0, 1e-9);
}

TEST(SelectPoses, ASetForPosesThatFailIsBetterAfterAFailure) {
  int better = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const PoseCandidates candidates = random_poses(40, 6, seed);
    const auto without_worst = [&](const std::vector<int>& chosen) {
      double worst = 0.0;
      for (const int gone : chosen) {
        std::vector<int> rest;
        for (const int pose : chosen) {
          if (pose != gone) rest.push_back(pose);
        }
        worst = std::max(worst, design_value(candidates, rest, PoseCriterion::gripper));
      }
      return worst;
    };
    const PoseSelection usual = select_poses(candidates, {.count = 5}),
                        robust = select_poses(candidates, {.count = 5, .failures = 1});
    EXPECT_LE(without_worst(robust.chosen), without_worst(usual.chosen) * (1.0 + 1e-4));
    better += without_worst(robust.chosen) < 0.99 * without_worst(usual.chosen) ? 1 : 0;
  }
  EXPECT_GE(better, 1);
}

TEST(SelectPoses, RefusesWhatDoesNotFit) {
  PoseCandidates candidates = random_poses(5, 3, 1);
  candidates.goal = Eigen::MatrixXd(Eigen::MatrixXd::Identity(4, 4));
  EXPECT_THROW((void)select_poses(candidates, {.count = 2}), std::invalid_argument);
  candidates = random_poses(5, 3, 1);
  candidates.information[2] =
      Eigen::MatrixXd(Eigen::MatrixXd::Constant(3, 3, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_THROW((void)select_poses(candidates, {.count = 2}), std::invalid_argument);
  EXPECT_THROW((void)select_poses({}, {.count = 2}), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal::test
