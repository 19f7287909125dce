#include "kinecal/trust/held_out.hpp"

#include <gtest/gtest.h>

#include "kinecal/solve/statistics.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(HeldOut, IsTheErrorOfFitsThatDidNotSeeTheFold) {
  test::NoisyScene scene(20);
  const Assessment found = scene.solve_and_assess({.folds = 5});
  const std::vector<int> fold = folds_of(scene.samples, each_its_own(scene.samples.size()), 5);
  double squares = 0.0;
  for (int k = 0; k < 5; ++k) {
    std::set<std::size_t> left_out;
    std::vector<Sample> held;
    for (std::size_t i = 0; i < fold.size(); ++i) {
      if (fold[i] != k) continue;
      left_out.insert(i);
      held.push_back(scene.samples[i]);
    }
    const Eigen::VectorXd values = scene.values_without(left_out);
    const auto norms = feature_norms(*scene.problem(held), scene.span(values));
    for (const double norm : norms[0]) squares += norm * norm;
  }
  ASSERT_EQ(found.held_out.size(), 1u);
  EXPECT_NEAR(found.held_out[0].held_out, std::sqrt(squares / 80.0), 1e-4 * test::kPointNoise);
  EXPECT_GT(found.held_out[0].held_out, found.held_out[0].fitted);
  EXPECT_NEAR(found.held_out[0].fitted, scene.result.blocks[0].after.rms, 1e-12);
}

TEST(HeldOut, FoldsDoNotDependOnTheOrderOfSamples) {
  test::NoisyScene scene(23);
  const std::vector<int> fold = folds_of(scene.samples, each_its_own(scene.samples.size()), 5);
  std::vector<Sample> reversed(scene.samples.rbegin(), scene.samples.rend());
  std::vector<int> again = folds_of(reversed, each_its_own(reversed.size()), 5);
  std::reverse(again.begin(), again.end());
  EXPECT_EQ(fold, again);
  for (int k = 0; k < 5; ++k) {
    const auto size = std::count(fold.begin(), fold.end(), k);
    EXPECT_TRUE(size == 4 || size == 5) << size;
  }
}

TEST(HeldOut, IsFarAboveTheFittedErrorWhereParametersFitTheNoise) {
  test::NoisyScene scene(2);  // 24 rows, 10 parameters
  const Assessment found = scene.solve_and_assess({.folds = 2});
  EXPECT_GT(found.held_out[0].held_out, 1.5 * found.held_out[0].fitted);
}

TEST(HeldOut, SaysHowManyFoldsAreDone) {
  test::NoisyScene scene(20);
  std::vector<double> done;
  AssessOptions options;
  options.meter = [&](double fraction, const std::string&) { done.push_back(fraction); };
  (void)scene.solve_and_assess(options);
  EXPECT_EQ(done, (std::vector<double>{0.2, 0.4, 0.6, 0.8, 1.0}));
}

}  // namespace
}  // namespace kinecal
