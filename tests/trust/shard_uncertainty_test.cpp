#include "kinecal/trust/shard_uncertainty.hpp"

#include <gtest/gtest.h>

#include "support/scene_shards.hpp"

namespace kinecal {
namespace {

/// Solves in shards.
ShardUncertainty known(const test::NoisyScene& scene, int size, Eigen::VectorXd& values) {
  const Eigen::VectorXd start = test::scene_table().values();
  values = start;
  test::SceneShards shards(scene, size);
  EXPECT_TRUE(solve_shards(shards.shards(), scene.free(), values, start).converged);
  return shard_uncertainty(shards.shards(), scene.free(), test::NoisyScene::span(start),
                           test::NoisyScene::span(values));
}

TEST(ShardUncertainty, IsThatOfAllSamplesAtOnce) {
  test::NoisyScene scene(1000);
  const Assessment all = scene.solve_and_assess({.folds = 0});
  Eigen::VectorXd values;
  const ShardUncertainty shards = known(scene, 130, values);
  EXPECT_EQ(shards.determined, all.uncertainty.determined);
  for (int i = 0; i < scene.free().size(); ++i) {
    const double ratio =
        shards.deviation[static_cast<std::size_t>(i)] / all.uncertainty.deviation(i, 0);
    EXPECT_NEAR(ratio, 1.0, 0.1) << scene.names[static_cast<std::size_t>(i)];
  }
  ASSERT_EQ(shards.misfits.size(), 8U);
  for (const double misfit : shards.misfits) EXPECT_NEAR(misfit, 1.0, 0.1);
  ASSERT_EQ(shards.blocks.size(), 1U);
  EXPECT_EQ(shards.blocks[0].name, "points");
  EXPECT_EQ(shards.blocks[0].features, 4000.0);
  EXPECT_NEAR(shards.blocks[0].rms_after, test::kPointNoise, 0.05 * test::kPointNoise);
  EXPECT_NEAR(shards.blocks[0].rms_before, scene.result.blocks[0].before.rms, 1e-12);
  EXPECT_NEAR(shards.blocks[0].rms_after, scene.result.blocks[0].after.rms, 1e-9);
}

TEST(ShardUncertainty, SeesFeaturesThatErrTogether) {
  constexpr int kSeeds = 60;
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
    Eigen::VectorXd values;
    const ShardUncertainty of = known(scene, 50, values);
    const auto column = static_cast<std::size_t>(scene.free().column(elbow));
    squares += std::pow(values(elbow) - scene.truth(elbow), 2);
    expected += std::pow(of.deviation[column], 2);
  }
  EXPECT_NEAR(std::sqrt(squares / expected), 1.0, 0.25);
}

TEST(ShardUncertainty, OfWhatNothingDeterminesIsInfinite) {
  test::NoisyScene scene(60);
  scene.names.insert(scene.names.end(), {"shoulder_pan", "head_pan_c"});
  Eigen::VectorXd values;
  const ShardUncertainty of = known(scene, 25, values);
  const FreeSet free = scene.free();
  for (int i = 0; i < free.size(); ++i) {
    const std::string& name =
        test::scene_table()[free.parameters()[static_cast<std::size_t>(i)]].name;
    const bool lost = name == "shoulder_pan" || name == "head_pan_c";
    EXPECT_EQ(std::isinf(of.deviation[static_cast<std::size_t>(i)]), lost) << name;
  }
}

}  // namespace
}  // namespace kinecal
