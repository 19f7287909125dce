// Features with ids: the order in which sensors list them, and which ones each has seen, change nothing
// but what can be compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "kinecal/errors.hpp"
#include "support/open_scene.hpp"
#include "support/scene.hpp"
#include "support/sums.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

constexpr double kSameTerms = 1e-12;

/// Samples of six features with errors, and ids from 10 on.
std::vector<Sample> numbered_samples(int count) {
  const Problem problem = test::scene_problem();
  const std::vector<double> truth = test::random_values(problem.table(), 0.02, 5);
  std::vector<Sample> samples = test::exact_samples(problem, truth, count, "hand", 1, 6);
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      for (std::size_t i = 0; i < seen.features.size(); ++i) {
        seen.features[i].point.x() += (seen.sensor == "eye" ? 3.0 : 0.02) * noise(random);
        seen.features[i].id = 10 + static_cast<int>(i);
      }
    }
  }
  return samples;
}

/// The features of an observation with some of the ids.
Observation only(const Observation& seen, int first, int last) {
  Observation part = seen;
  std::erase_if(part.features, [&](const Feature& f) { return *f.id < first || *f.id > last; });
  return part;
}

Sample with(const Sample& sample, std::vector<Observation> observations) {
  Sample other = sample;
  other.observations = std::move(observations);
  return other;
}

template <class S>
BasicProblem<S> problem_of(std::span<const Sample> samples) {
  BasicProblem<S> problem = test::scene_problem<S>();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"},
                    {.sigma = 0.01, .loss = {LossType::huber, 2.0}});
  problem.add_block("pixels", PointToPixel{}, {"arm", "eye"}, {.sigma = 2.0});
  for (const Sample& sample : samples) problem.add_sample(sample);
  return problem;
}

template <class S>
NormalEquations sums_of(const BasicProblem<S>& problem) {
  const FreeSet free = test::all_free(problem.table());
  return normal_equations(problem, test::random_values(problem.table(), 0.03, 8), &free);
}

template <class S>
class FeatureIds : public testing::Test {};
using Scalars = testing::Types<double, Packet>;
TYPED_TEST_SUITE(FeatureIds, Scalars);

TYPED_TEST(FeatureIds, InAnyOrderGiveTheIdenticalResult) {
  using S = TypeParam;
  std::vector<Sample> samples = numbered_samples(2 * kLanes<S> + 1), plain = samples;
  std::mt19937 random(3);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    for (Observation& seen : plain[n].observations) {
      for (Feature& feature : seen.features) feature.id.reset();
    }
    for (Observation& seen : samples[n].observations) {
      std::shuffle(seen.features.begin(), seen.features.end(), random);
    }
  }
  const NormalEquations found = sums_of(problem_of<S>(samples));
  const NormalEquations expected = sums_of(problem_of<S>(plain));
  EXPECT_EQ(found.cost, expected.cost);
  EXPECT_EQ(found.gradient, expected.gradient);
  EXPECT_EQ(found.hessian, expected.hessian);
}

/// The oracle: each camera with its part of the board as a sample of its own.
TYPED_TEST(FeatureIds, TwoCamerasThatSeeDifferentPartsAreAsTwoSamples) {
  using S = TypeParam;
  std::vector<Sample> samples, split;
  for (const Sample& sample : numbered_samples(3 * kLanes<S> + 2)) {
    const auto& [arm, camera, eye] =
        std::tie(sample.observations[0], sample.observations[1], sample.observations[2]);
    samples.push_back(with(sample, {arm, only(camera, 10, 13), only(eye, 12, 15)}));
    split.push_back(with(sample, {only(arm, 10, 13), only(camera, 10, 13)}));
    split.push_back(with(sample, {only(arm, 12, 15), only(eye, 12, 15)}));
  }
  const auto problem = problem_of<S>(samples), by_hand = problem_of<S>(split);
  EXPECT_EQ(problem.num_residuals(), by_hand.num_residuals());
  EXPECT_EQ(problem.samples_of(0), problem.num_samples());
  test::expect_same(sums_of(problem), sums_of(by_hand), kSameTerms);
}

TYPED_TEST(FeatureIds, AFeatureThatTakesItsSigmaWithIt) {
  using S = TypeParam;
  std::vector<Sample> samples = numbered_samples(kLanes<S> + 1);
  for (Sample& sample : samples) {
    for (std::size_t i = 0; i < 6; ++i) {
      sample.observations[1].features[i].sigma = 0.01 + 0.002 * double(i);
    }
    sample.observations[0].features[4].sigma = 0.003;
  }
  std::vector<Sample> split = samples;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    std::vector<Observation>& seen = samples[n].observations;
    Observation &arm = seen[0], &camera = seen[1], &eye = seen[2];
    split[n].observations = {only(arm, 11, 14), only(camera, 11, 14), only(eye, 11, 14)};
    camera = only(camera, 11, 14);
    eye = only(eye, 10, 14);
    std::reverse(camera.features.begin(), camera.features.end());
    arm = only(arm, 11, 15);
  }
  test::expect_same(sums_of(problem_of<S>(samples)), sums_of(problem_of<S>(split)), kSameTerms);
}

/// Sensors of poses: a gap needs an orientation, too.
TYPED_TEST(FeatureIds, OfPosesMayHaveGaps) {
  using S = TypeParam;
  const auto make = [](std::span<const Sample> samples) {
    auto problem = test::open_problem<S>(PoseToPose{2.0, 0.7}, {"body", "tracker"});
    for (const Sample& sample : samples) problem.add_sample(sample);
    return problem;
  };
  const auto empty = make({});
  const std::vector<double> zero(static_cast<std::size_t>(empty.table().size()), 0.0);
  std::vector<Sample> samples = test::open_samples(empty, zero, kLanes<S> + 2), split = samples;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    for (const std::size_t o : {5u, 6u}) {  // body and tracker
      auto& features = samples[n].observations[o].features;
      for (std::size_t i = 0; i < features.size(); ++i) features[i].id = static_cast<int>(i);
    }
    std::vector<Observation>& seen = samples[n].observations;
    ASSERT_EQ(seen[5].sensor, "body");
    split[n].observations = {only(seen[5], 1, 2), only(seen[6], 1, 2)};
    seen = {only(seen[5], 1, 3), only(seen[6], 0, 2)};
    std::reverse(seen[0].features.begin(), seen[0].features.end());
  }
  test::expect_same(sums_of(make(samples)), sums_of(make(split)), kSameTerms);
}

/// Three sensors in a row: the one in the middle saw all, so those at the ends have gaps.
TYPED_TEST(FeatureIds, GapsCountForNothing) {
  using S = TypeParam;
  const Sample first = numbered_samples(1)[0];
  const auto& seen = first.observations;
  Sample sample = with(first, {seen[0], only(seen[1], 10, 11), only(seen[2], 14, 15)});
  const auto problem = problem_of<S>(std::vector{sample});
  EXPECT_EQ(problem.num_residuals(), 2 * 3 + 2 * 2);
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  std::map<int, Eigen::Index> rows;
  EXPECT_EQ(evaluate(problem, zero, nullptr,
                     [&](int t, int, const TermResiduals& of) { rows[t] = of.residual.size(); }),
            std::nullopt);
  EXPECT_EQ(rows, (std::map<int, Eigen::Index>{{0, 6}, {1, 4}}));
  EXPECT_EQ(problem.feature(0, 0, 1).text(), "the feature with id 11");
  EXPECT_EQ(problem.feature(1, 0, 1).text(), "the feature with id 15");
}

TEST(FeatureLabels, NumberFeaturesAsTheFirstSensorListsThem) {
  const Sample first = numbered_samples(1)[0];
  Sample sample = with(first, {first.observations[0], only(first.observations[1], 12, 14)});
  auto& camera = sample.observations[1].features;
  std::reverse(camera.begin(), camera.end());  // 14 13 12
  const auto problem = problem_of<double>(std::vector{sample});
  EXPECT_EQ(problem.feature(0, 0, 0).id, 12);
  EXPECT_EQ(problem.feature(0, 0, 0).place, 2);
  EXPECT_EQ(problem.feature(0, 0, 2).id, 14);
  EXPECT_EQ(problem.feature(0, 0, 2).place, 0);
}

/// Rows have no place for a feature that is not a number; the one behind it keeps its number.
TEST(FeatureLabels, CountFeaturesThatAreNoNumbers) {
  Sample sample = numbered_samples(1)[0];
  for (Observation& seen : sample.observations) {
    for (Feature& feature : seen.features) feature.id.reset();
  }
  sample.observations[0].features[2].point.x() = std::nan("");
  const auto problem = problem_of<double>(std::vector{sample});
  EXPECT_EQ(problem.feature(0, 0, 1).text(), "feature 2");
  EXPECT_EQ(problem.feature(0, 0, 2).text(), "feature 4");
}

TEST(FeatureIdsOfASample, InCommonToNoSensorsLeaveTheBlockOut) {
  const Sample first = numbered_samples(1)[0];
  const auto& seen = first.observations;
  const Sample sample = with(first, {only(seen[0], 12, 15), only(seen[1], 10, 11), seen[2]});
  const auto problem = problem_of<double>(std::vector{sample});
  EXPECT_EQ(problem.samples_of(0), 0);
  EXPECT_EQ(problem.samples_of(1), 1);
  EXPECT_EQ(problem.num_residuals(), 4 * 2);
  const Sample alone = with(first, {only(seen[0], 12, 15), only(seen[1], 10, 11)});
  EXPECT_EQ(problem_of<double>(std::vector{alone}).num_residuals(), 0);
}

TEST(FeatureIdsOfASample, AreNamedInErrorsWithItsPlace) {
  const auto message = [](const Sample& sample) {
    return test::thrown<SampleError>([&] { (void)problem_of<double>(std::vector{sample}); });
  };
  Sample sample = numbered_samples(1)[0];
  sample.source = "s.yaml:7";
  sample.observations[1].features[3].id = 10;
  EXPECT_EQ(message(sample),
            "s.yaml:7: sensor 'camera': two features have the id 10; each feature needs an id of "
            "its own");
  for (Feature& feature : sample.observations[1].features) feature.id.reset();
  sample.observations[1].features.pop_back();
  EXPECT_THAT(message(sample),
              HasSubstr("sensor 'camera' has 5 features, sensor 'arm' has 6; give them ids"));
}

}  // namespace
}  // namespace kinecal
