#include "kinecal/solve/shards.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "support/scene_shards.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

std::vector<double> start_values() {
  const Eigen::VectorXd start = test::scene_table().values();
  return {start.begin(), start.end()};
}

double distance(const std::vector<double>& a, const Eigen::VectorXd& b) {
  return (Eigen::Map<const Eigen::VectorXd>(a.data(), std::ssize(a)) - b).norm();
}

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
  const std::vector<double> start = start_values();
  scene.solve();
  for (const int size : {1, 7, 40, 100}) {
    test::SceneShards shards(scene, size);
    std::vector<double> values = start;
    const StepResult result = solve_shards(shards.shards(), scene.free(), values, start);
    ASSERT_TRUE(result.converged) << result.termination;
    EXPECT_NEAR(result.final_cost, scene.result.steps[0].final_cost, 1e-9 * result.final_cost);
    EXPECT_LT(distance(values, scene.values()), 1e-7) << size;
    EXPECT_EQ(result.samples, 40);
  }
}

TEST(Shards, GoBackToTheReferenceAlongWhatNothingDetermines) {
  test::NoisyScene scene(40);
  scene.names.insert(scene.names.end(), {"shoulder_pan", "head_pan_c"});
  scene.solve();
  test::SceneShards shards(scene, 9);
  const std::vector<double> reference = start_values();
  std::vector<double> values = reference;
  values[static_cast<std::size_t>(test::scene_table().index("shoulder_pan"))] +=
      0.2;  // a start elsewhere
  ASSERT_TRUE(solve_shards(shards.shards(), scene.free(), values, reference).converged);
  EXPECT_LT(distance(values, scene.values()), 1e-6);
}

TEST(Shards, WithALossGiveTheSolutionOfAllSamples) {
  test::NoisyScene scene(40);
  scene.options.loss = {LossType::cauchy, 3.0};
  scene.samples[3].observations[0].features[1].point.x() += 0.5;
  scene.solve();
  test::SceneShards shards(scene, 11);
  const std::vector<double> reference = start_values();
  std::vector<double> values = reference;
  ASSERT_TRUE(solve_shards(shards.shards(), scene.free(), values, reference).converged);
  EXPECT_LT(distance(values, scene.values()), 1e-6);
}

TEST(Shards, AreTheSameToTheLastBitWhoeverComputesThem) {
  const test::NoisyScene scene(30);
  const std::vector<double> start = start_values();
  test::SceneShards alone(scene, 4), shared(scene, 4);
  std::map<std::string, std::vector<std::vector<double>>> store;
  shared.shards().exchange = [&](const std::string& what, const NumbersOfShard& numbers_of) {
    std::vector<std::vector<double>>& all = store[what];
    if (!all.empty()) return all;  // another process has them
    all.resize(8);
    for (int shard = 7; shard >= 0; --shard) all[std::size_t(shard)] = numbers_of(shard);
    return all;
  };
  std::vector<double> one = start, other = start, again = start;
  (void)solve_shards(alone.shards(), scene.free(), one, start);
  (void)solve_shards(shared.shards(), scene.free(), other, start);
  EXPECT_EQ(one, other);
  const int reads = shared.reads;
  (void)solve_shards(shared.shards(), scene.free(), again, start);
  EXPECT_EQ(one, again);
  EXPECT_EQ(shared.reads, reads) << "nothing is computed twice";
}

TEST(Shards, ThatCannotBeReadLeaveTheValuesAlone) {
  const test::NoisyScene scene(12);
  test::SceneShards shards(scene, 5);
  const auto read = shards.shards().read;
  shards.shards().read = [&](int shard) {
    if (shards.reads > 7) throw std::runtime_error("second.bag: is cut off");
    return read(shard);
  };
  const std::vector<double> start = start_values();
  std::vector<double> values = start;
  const std::string why = test::thrown<std::runtime_error>(
      [&] { (void)solve_shards(shards.shards(), scene.free(), values, start); });
  EXPECT_EQ(why, "second.bag: is cut off");
  EXPECT_EQ(values, start);
}

TEST(Shards, NumbersOfAnotherProblemAreRefused) {
  const test::NoisyScene scene(12);
  test::SceneShards shards(scene, 5);
  shards.shards().exchange = [](const std::string&, const NumbersOfShard&) {
    return std::vector<std::vector<double>>(3, {1.0, 2.0});
  };
  const auto evaluator = shard_evaluator(shards.shards(), scene.free());
  EXPECT_THROW((void)evaluator->normal_equations(start_values()), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
