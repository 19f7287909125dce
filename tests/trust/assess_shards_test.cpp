#include "kinecal/trust/assess_shards.hpp"

#include <gtest/gtest.h>

#include "support/scene_shards.hpp"

namespace kinecal {
namespace {

/// Solves in shards, and assesses.
ShardAssessment known(const test::NoisyScene& scene, int size, std::vector<double>& values) {
  const Eigen::VectorXd start = test::scene_table().values();
  values.assign(start.begin(), start.end());
  test::SceneShards shards(scene, size);
  EXPECT_TRUE(
      solve_shards(shards.shards(), scene.free(), values, test::NoisyScene::span(start)).converged);
  const std::vector<Sample> first(scene.samples.begin(), scene.samples.begin() + size);
  const auto drawn = scene.problem(first);
  return assess_shards(shards.shards(), scene.free(), test::NoisyScene::span(start), values, *drawn,
                       first);
}

TEST(AssessShards, SaysWhatAllSamplesAtOnceSay) {
  test::NoisyScene scene(1000);
  const Assessment all = scene.solve_and_assess({.folds = 0});
  std::vector<double> values;
  const ShardAssessment shards = known(scene, 130, values);
  const Assessment& of = shards.assessment;
  EXPECT_EQ(of.uncertainty.determined, all.uncertainty.determined);
  for (int i = 0; i < scene.free().size(); ++i) {
    EXPECT_NEAR(of.uncertainty.deviation(i) / all.uncertainty.deviation(i), 1.0, 0.1)
        << scene.names[static_cast<std::size_t>(i)];
  }
  ASSERT_EQ(shards.misfits.size(), 8U);
  for (const double misfit : shards.misfits) EXPECT_NEAR(misfit, 1.0, 0.1);
  ASSERT_EQ(of.noise.size(), 1U);
  EXPECT_EQ(of.noise[0].features, 4000);
  EXPECT_NEAR(of.noise[0].freedom, all.noise[0].freedom, 1e-4);
  EXPECT_NEAR(of.noise[0].sigma, all.noise[0].sigma, 1e-6 * all.noise[0].sigma);
  EXPECT_NEAR(of.noise[0].robust, all.noise[0].robust, 0.004 * all.noise[0].robust);
  EXPECT_EQ(of.rows, all.rows);
  EXPECT_EQ(of.observability.rank, all.observability.rank);
  EXPECT_NEAR(of.observability.condition, all.observability.condition,
              1e-6 * all.observability.condition);
  ASSERT_FALSE(of.compared.empty() || all.compared.empty());
  EXPECT_NEAR(of.compared[0].position, all.compared[0].position, 0.1 * all.compared[0].position);
}

TEST(AssessShards, HasTheStatisticsOfAllResiduals) {
  test::NoisyScene scene(100);
  scene.solve();
  std::vector<double> values;
  const ShardAssessment shards = known(scene, 30, values);
  ASSERT_EQ(shards.blocks.size(), 1U);
  const BlockStatistics &one = shards.blocks[0], &all = scene.result.blocks[0];
  EXPECT_EQ(one.name, "points");
  EXPECT_EQ(one.count, 400);
  for (const auto& [a, b] : {std::pair(one.before, all.before), std::pair(one.after, all.after)}) {
    EXPECT_NEAR(a.rms, b.rms, 1e-6 * b.rms);
    EXPECT_NEAR(a.mean, b.mean, 1e-6 * b.mean);
    EXPECT_NEAR(a.max, b.max, 1e-5 * b.max);
    EXPECT_NEAR(a.median, b.median, 0.01 * b.median);
  }
}

TEST(AssessShards, SeesFeaturesThatErrTogether) {
  constexpr int kSeeds = 20;
  const int elbow = test::scene_table().index("elbow");
  double squares = 0.0, expected = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    test::NoisyScene scene(200, 5);  // the same poses
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 5.0 * test::kPointNoise);
    for (Sample& sample : scene.samples) {
      const Vector3<double> all(noise(random), noise(random), noise(random));
      for (Feature& feature : sample.observations[0].features) feature.point += all;
    }
    std::vector<double> values;
    const ShardAssessment of = known(scene, 50, values);
    squares += std::pow(values[static_cast<std::size_t>(elbow)] - scene.truth(elbow), 2);
    expected += std::pow(of.assessment.uncertainty.deviation(scene.free().column(elbow)), 2);
  }
  EXPECT_NEAR(std::sqrt(squares / expected), 1.0, 0.25);
}

TEST(AssessShards, NamesWhatNothingDetermines) {
  test::NoisyScene scene(60);
  scene.names.insert(scene.names.end(), {"shoulder_pan", "head_pan_c"});
  const Assessment all = scene.solve_and_assess({.folds = 0});
  std::vector<double> values;
  const Assessment of = known(scene, 25, values).assessment;
  ASSERT_EQ(of.observability.unobservable.size(), all.observability.unobservable.size());
  ASSERT_FALSE(of.observability.unobservable.empty());
  EXPECT_EQ(of.observability.hold, all.observability.hold);
  for (int i = 0; i < scene.free().size(); ++i) {
    EXPECT_EQ(std::isinf(of.uncertainty.deviation(i)), std::isinf(all.uncertainty.deviation(i)));
  }
}

TEST(AssessShards, FindsTheShardThatDoesNotFit) {
  test::NoisyScene scene(90);
  for (std::size_t i = 60; i < 90; ++i) {
    for (Feature& feature : scene.samples[i].observations[0].features) feature.point.x() += 0.02;
  }
  std::vector<double> values;
  const std::vector<double> misfits = known(scene, 30, values).misfits;
  ASSERT_EQ(misfits.size(), 3U);
  EXPECT_GT(misfits[2], 1.5 * misfits[0]);
}

}  // namespace
}  // namespace kinecal
