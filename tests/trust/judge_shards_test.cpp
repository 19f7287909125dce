#include "kinecal/trust/judge_shards.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "support/photographs.hpp"

namespace kinecal {
namespace {

using test::Photographs;

/// Photographs in three shards of different size, against all of them at once.
struct InShards {
  static constexpr std::size_t kSecond = 60, kThird = 90;

  InShards(Photographs photographs, std::vector<std::string> free)
      : all(std::move(photographs)), names(std::move(free)), at_once(all.calibration(names)) {
    ProcedureOptions options;
    options.keep_outliers = true;
    once = calibrate_and_judge(at_once, all.samples, options);
  }
  [[nodiscard]] JudgedResult calibrate(const ShardExchange& exchange = {}) {
    Photographs drawn = all;
    drawn.samples.resize(kSecond);
    Calibration of_draw = drawn.calibration(names);
    const ShardedCalibration sharded{
        .calibration = of_draw,
        .samples = drawn.samples,
        .names = {"a", "b", "c"},
        .num_samples = std::ssize(all.samples),
        .num_residuals = {at_once.steps[0].problem->num_residuals()},
        .free = {at_once.steps[0].free},
        .read =
            [this](int shard) {
              const auto at = [&](std::size_t place) {
                return all.samples.begin() + static_cast<std::ptrdiff_t>(place);
              };
              return shard == 0   ? std::vector<Sample>(at(0), at(kSecond))
                     : shard == 1 ? std::vector<Sample>(at(kSecond), at(kThird))
                                  : std::vector<Sample>(at(kThird), all.samples.end());
            },
        .exchange = exchange};
    return calibrate_and_judge(sharded);
  }

  Photographs all;
  std::vector<std::string> names;
  Calibration at_once;
  JudgedResult once;
};

const std::vector<std::string> kLens = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};

/// Each photograph has a pose of the board of its own, which uses up six rows.
TEST(JudgeShards, SamplePosesAreAsWithAllSamplesAtOnce) {
  InShards shards({test::distorted_camera(), "plumb_bob", {.views = 240}}, kLens);
  const JudgedResult judged = shards.calibrate();
  ASSERT_TRUE(judged.result.converged && shards.once.result.converged);
  const Assessment &of = judged.assessments.back(), &all = shards.once.assessments.back();
  double ratios = 0.0;
  for (int i = 0; i < std::ssize(kLens); ++i) {
    const double deviation = all.uncertainty.deviation(i);
    EXPECT_NEAR(judged.result.table[i].value, shards.once.result.table[i].value, 1e-3 * deviation)
        << kLens[static_cast<std::size_t>(i)];
    // Gradients of n photographs show a variance to 1 / sqrt(2 n); of 240, few determine k3.
    const double ratio = of.uncertainty.deviation(i) / deviation;
    EXPECT_NEAR(ratio, 1.0, 0.4) << kLens[static_cast<std::size_t>(i)];
    ratios += ratio / static_cast<double>(kLens.size());
  }
  EXPECT_NEAR(ratios, 1.0, 0.15);
  EXPECT_EQ(of.rows, all.rows);
  EXPECT_NEAR(of.used, 6.0 * 240.0, 1e-6);
  EXPECT_NEAR(of.used, all.used, 1e-6);
  EXPECT_NEAR(of.noise[0].freedom, all.noise[0].freedom, 1e-4);
  EXPECT_NEAR(of.noise[0].sigma, all.noise[0].sigma, 1e-6 * all.noise[0].sigma);
  EXPECT_NEAR(of.noise[0].robust, all.noise[0].robust, 0.004 * all.noise[0].robust);
  EXPECT_NEAR(judged.result.steps[0].final_cost, shards.once.result.steps[0].final_cost,
              1e-9 * judged.result.steps[0].final_cost);
  EXPECT_EQ(judged.judgement.verdict, shards.once.judgement.verdict);
}

/// 1 - 0.25 r^2 falls over before the corners of the image: all shards know where, only the last one has the farthest
/// feature.
TEST(JudgeShards, ALensThatFoldsOverIsSeen) {
  CameraInfo folding = test::distorted_camera();
  folding.d = {-0.25, 0.0, 0.0, 0.0, 0.0};
  InShards shards({folding, "plumb_bob", {.views = 110, .aside = 0.1}}, kLens);
  const JudgedResult judged = shards.calibrate();
  const auto &of = judged.assessments.back().folded, &all = shards.once.assessments.back().folded;
  ASSERT_EQ(all.size(), 1U);
  ASSERT_EQ(of.size(), 1U);
  EXPECT_EQ(of[0].sensor, "camera");
  EXPECT_NEAR(of[0].radius, all[0].radius, 0.1);
  EXPECT_NEAR(of[0].farthest, all[0].farthest, 0.1);
  EXPECT_EQ(judged.judgement.verdict, shards.once.judgement.verdict);
}

TEST(JudgeShards, OneWrongCornerIsNamedByItsFile) {
  const auto far_reasons = [](double off_by) {
    Photographs photographs{test::distorted_camera(), "plumb_bob", {.views = 110}};
    for (Observation& seen : photographs.samples[100].observations) {
      if (seen.sensor == "camera") seen.features[7].point.x() += off_by;
    }
    InShards shards(photographs, kLens);
    std::vector<std::string> reasons = shards.calibrate().judgement.reasons;
    std::erase_if(reasons, [](const std::string& reason) {
      return reason.find(": a feature of error block") == std::string::npos;
    });
    return reasons;
  };
  EXPECT_THAT(far_reasons(50.0), testing::ElementsAre(testing::HasSubstr("c: a feature of")));
  EXPECT_THAT(far_reasons(0.0), testing::IsEmpty());
}

TEST(JudgeShards, AFileThatIsThereTwiceIsNamed) {
  Photographs photographs{test::distorted_camera(), "plumb_bob", {.views = 110}};
  photographs.samples.resize(InShards::kThird);
  photographs.samples.insert(photographs.samples.end(),
                             photographs.samples.begin() + InShards::kSecond,
                             photographs.samples.begin() + InShards::kThird);
  InShards shards(photographs, kLens);
  EXPECT_THAT(shards.calibrate().judgement.reasons,
              testing::Contains(testing::HasSubstr("c: has the samples of b; copies count twice")));
}

/// Sums that were found on disk are those of another process, to the last bit.
TEST(JudgeShards, SamplePosesDoNotDependOnWhatWasComputedBefore) {
  InShards shards({test::distorted_camera(), "plumb_bob", {.views = 110}}, kLens);
  std::map<std::string, std::vector<std::vector<double>>> store;
  int computed = 0;
  const ShardExchange exchange = [&](const std::string& what, const NumbersOfShard& numbers_of) {
    std::vector<std::vector<double>>& all = store[what];
    if (!all.empty()) return all;
    ++computed;
    all.resize(3);
    for (int shard = 2; shard >= 0; --shard) {
      all[static_cast<std::size_t>(shard)] = numbers_of(shard);
    }
    return all;
  };
  const JudgedResult alone = shards.calibrate(), shared = shards.calibrate(exchange);
  const int before = computed;
  // Half of them are there, as after a computer was switched off.
  bool is_lost = false;
  for (auto& [what, all] : store) {
    if (is_lost) all.clear();
    is_lost = !is_lost;
  }
  const JudgedResult again = shards.calibrate(exchange);
  EXPECT_LT(computed, 2 * before);
  for (int i = 0; i < alone.result.table.size(); ++i) {
    EXPECT_EQ(alone.result.table[i].value, shared.result.table[i].value);
    EXPECT_EQ(alone.result.table[i].value, again.result.table[i].value);
  }
}

}  // namespace
}  // namespace kinecal
