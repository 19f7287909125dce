#include "kinecal/solve/shards.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "support/scene_shards.hpp"

namespace kinecal {
namespace {

TEST(Shards, HaveTheSumsOfAllSamples) {
  const test::NoisyScene scene(23);
  test::SceneShards shards(scene, 5);
  const auto values = test::NoisyScene::span(scene.truth);
  const NormalEquations all =
      scene.problem(scene.samples)->evaluator(scene.free())->normal_equations(values);
  const auto evaluator = shard_evaluator(shards.shards(), scene.free());
  const NormalEquations sums = evaluator->normal_equations(values);
  EXPECT_NEAR(sums.cost, all.cost, 1e-12 * all.cost);
  EXPECT_LT((sums.gradient - all.gradient).norm(), 1e-9 * all.gradient.norm());
  EXPECT_LT((sums.hessian - all.hessian).norm(), 1e-12 * all.hessian.norm());
  EXPECT_EQ(shards.reads, 5);
  (void)evaluator->normal_equations(values, false);
  EXPECT_EQ(shards.reads, 5) << "the last sums are kept";
}

TEST(Shards, GiveTheSolutionOfAllSamples) {
  test::NoisyScene scene(40);
  const Eigen::VectorXd start = test::scene_table().values();
  scene.solve();
  for (const int size : {1, 7, 40, 100}) {
    test::SceneShards shards(scene, size);
    Eigen::VectorXd values = start;
    const StepResult result = solve_shards(shards.shards(), scene.free(), values, start);
    ASSERT_TRUE(result.converged) << result.termination;
    EXPECT_NEAR(result.final_cost, scene.result.steps[0].final_cost, 1e-9 * result.final_cost);
    EXPECT_LT((values - scene.values()).norm(), 1e-7) << size;
    EXPECT_EQ(result.samples, 40);
  }
}

TEST(Shards, GoBackToTheReferenceAlongWhatNothingDetermines) {
  test::NoisyScene scene(40);
  scene.names.insert(scene.names.end(), {"shoulder_pan", "head_pan_c"});
  scene.solve();
  test::SceneShards shards(scene, 9);
  const Eigen::VectorXd reference = test::scene_table().values();
  Eigen::VectorXd values = reference;
  values(test::scene_table().index("shoulder_pan")) += 0.2;  // a start elsewhere
  ASSERT_TRUE(solve_shards(shards.shards(), scene.free(), values, reference).converged);
  EXPECT_LT((values - scene.values()).norm(), 1e-6);
}

TEST(Shards, WithALossGiveTheSolutionOfAllSamples) {
  test::NoisyScene scene(40);
  scene.options.loss = {LossType::cauchy, 3.0};
  scene.samples[3].observations[0].features[1].point.x() += 0.5;
  scene.solve();
  test::SceneShards shards(scene, 11);
  const Eigen::VectorXd reference = test::scene_table().values();
  Eigen::VectorXd values = reference;
  ASSERT_TRUE(solve_shards(shards.shards(), scene.free(), values, reference).converged);
  EXPECT_LT((values - scene.values()).norm(), 1e-6);
}

TEST(Shards, AreTheSameToTheLastBitWhoeverComputesThem) {
  const test::NoisyScene scene(30);
  const Eigen::VectorXd start = test::scene_table().values();
  test::SceneShards alone(scene, 4), shared(scene, 4);
  std::map<std::string, std::vector<std::vector<double>>> store;
  shared.shards().exchange = [&](const std::string& what, const NumbersOfShard& numbers_of) {
    std::vector<std::vector<double>>& all = store[what];
    if (!all.empty()) return all;  // another process has them
    all.resize(8);
    for (int shard = 7; shard >= 0; --shard) all[std::size_t(shard)] = numbers_of(shard);
    return all;
  };
  Eigen::VectorXd one = start, other = start, again = start;
  (void)solve_shards(alone.shards(), scene.free(), one, start);
  (void)solve_shards(shared.shards(), scene.free(), other, start);
  EXPECT_EQ((one - other).norm(), 0.0);
  const int reads = shared.reads;
  (void)solve_shards(shared.shards(), scene.free(), again, start);
  EXPECT_EQ((one - again).norm(), 0.0);
  EXPECT_EQ(shared.reads, reads) << "nothing is computed twice";
}

TEST(Shards, NameTheSampleWhoseResidualIsUndefined) {
  test::NoisyScene scene(12);
  scene.samples[7].observations[0].features[0].point.z() = std::numeric_limits<double>::quiet_NaN();
  scene.samples[7].source = "second.yaml:37";
  test::SceneShards shards(scene, 5);
  Eigen::VectorXd values = test::scene_table().values();
  const Eigen::VectorXd start = values;
  std::string why;
  try {
    why = solve_shards(shards.shards(), scene.free(), values, start).termination;
  } catch (const std::exception& error) {
    why = error.what();
  }
  EXPECT_THAT(why, testing::HasSubstr("second.yaml:37"));
  EXPECT_EQ((values - start).norm(), 0.0);
}

}  // namespace
}  // namespace kinecal
