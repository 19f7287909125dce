// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/neighbours.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// Adds a walk of the camera's points in the base: each sample keeps `keep` of the error of the one before.
void add_walk(test::NoisyScene& scene, double keep, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 3e-3);
  const auto problem = test::scene_problem();
  Vector3<double> error = Vector3<double>::Zero();
  for (Sample& sample : scene.samples) {
    error = keep * error + Vector3<double>{noise(random), noise(random), noise(random)};
    const Pose<double> camera = test::tip_pose(problem, 1, "camera_optical_frame", sample,
                                               test::NoisyScene::span(scene.truth));
    const Vector3<double> seen = camera.rotation.transpose() * error;
    for (Observation& observed : sample.observations) {
      if (observed.sensor != "camera") continue;
      for (Feature& feature : observed.features) feature.point += seen;
    }
  }
}

TEST(Neighbours, AreNotAlikeByChance) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::NoisyScene scene(60, seed);
    add_walk(scene, 0.0, seed);
    EXPECT_EQ(scene.solve_and_assess().neighbours.together, 1) << seed;
  }
}

TEST(Neighbours, ThatErrAlikeCountAsOneAndWidenTheIntervals) {
  test::NoisyScene scene(150);
  add_walk(scene, 0.7, 1);
  const Assessment together = scene.solve_and_assess();
  EXPECT_NEAR(together.neighbours.correlation, 0.65, 0.15);
  EXPECT_GE(together.neighbours.together, 3);
  std::shuffle(scene.samples.begin(), scene.samples.end(), std::mt19937(1));
  const Assessment alone = scene.solve_and_assess();
  EXPECT_EQ(alone.neighbours.together, 1);
  double ratio = 0.0;
  for (std::size_t i = 0; i < alone.parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    ratio += together.uncertainty.deviation(k) / alone.uncertainty.deviation(k) /
             static_cast<double>(alone.parameters.size());
  }
  EXPECT_GT(ratio, 1.2);
}

TEST(Neighbours, AreJoinedInTheirOrder) {
  const PoseGroups groups = joined({{0, 0, 1, 2, 3, 4}, 5}, 2);
  EXPECT_EQ(groups.of_sample, (std::vector<int>{0, 0, 0, 1, 1, 2}));
  EXPECT_EQ(groups.count, 3);
}

}  // namespace
}  // namespace kinecal
