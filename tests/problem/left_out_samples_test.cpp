// Samples that are left out of a problem, and sigmas that are set: as if it had been made so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using test::NoisyScene;

/// All rows of a problem, by sample and term.
std::map<std::pair<int, int>, Eigen::VectorXd> rows_of(const AnyProblem& problem,
                                                       const Eigen::VectorXd& values) {
  std::map<std::pair<int, int>, Eigen::VectorXd> all;
  EXPECT_FALSE(evaluate(problem, NoisyScene::span(values), nullptr,
                        [&](int term, int sample, const TermResiduals& rows) {
                          all[{sample, term}] = rows.factor.cwiseProduct(rows.residual);
                        }));
  return all;
}

/// Samples of two layouts: every third one lacks a feature, another has ids or sigmas.
std::vector<Sample> unlike_samples(int count) {
  std::vector<Sample> samples = NoisyScene(count).samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (Observation& seen : samples[i].observations) {
      if (i % 3 == 1) seen.features.pop_back();
      if (i % 5 != 2) continue;
      for (std::size_t f = 0; f < seen.features.size(); ++f) {
        seen.features[f].id = 10 + static_cast<int>(f);
        if (f % 2 == 0) seen.features[f].sigma = 1e-3 * (1.0 + static_cast<double>(f));
      }
    }
  }
  return samples;
}

void expect_same(const AnyProblem& one, const AnyProblem& other, const Eigen::VectorXd& values,
                 const FreeSet& free) {
  ASSERT_EQ(one.num_samples(), other.num_samples());
  EXPECT_EQ(one.num_residuals(), other.num_residuals());
  EXPECT_EQ(one.touched_parameters(), other.touched_parameters());
  EXPECT_EQ(one.samples_of(0), other.samples_of(0));
  const auto a = rows_of(one, values), b = rows_of(other, values);
  EXPECT_EQ(a, b);
  for (int i = 0; i < one.num_samples(); ++i) {
    EXPECT_EQ(one.source(i), other.source(i));
    EXPECT_EQ(one.feature(0, i, 1).text(), other.feature(0, i, 1).text());
  }
  const NormalEquations of_one = normal_equations(one, NoisyScene::span(values), &free);
  const NormalEquations of_other = normal_equations(other, NoisyScene::span(values), &free);
  constexpr double kRounding = 1e-13;  // sums in another order
  EXPECT_NEAR(of_one.cost, of_other.cost, kRounding * of_other.cost);
  EXPECT_LE((of_one.hessian - of_other.hessian).norm(), kRounding * of_other.hessian.norm());
}

TEST(LeftOutSamples, AreAsIfTheyHadNeverBeenAdded) {
  const NoisyScene scene(1);
  std::vector<Sample> samples = unlike_samples(40);
  const std::unique_ptr<AnyProblem> problem = scene.problem(samples);
  for (const std::set<int>& left_out : {std::set<int>{0, 1, 7, 39}, {}, {35}, {2, 3, 4, 5, 6, 8}}) {
    problem->exclude(left_out);
    for (auto i = left_out.rbegin(); i != left_out.rend(); ++i) samples.erase(samples.begin() + *i);
    expect_same(*problem, *scene.problem(samples), scene.truth, scene.free());
  }
  problem->add_sample(samples[0]);
  samples.push_back(samples[0]);
  expect_same(*problem, *scene.problem(samples), scene.truth, scene.free());
}

/// The samples with points elsewhere.
std::vector<Sample> moved(std::vector<Sample> samples) {
  double shift = 0.0;
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      for (Feature& feature : seen.features) feature.point.array() += 1e-3 * std::sin(shift += 0.7);
    }
  }
  return samples;
}

TEST(Measurements, ThatAreReplacedAreAsIfTheyHadBeenAdded) {
  const NoisyScene scene(1);
  std::vector<Sample> samples = unlike_samples(40);
  const std::unique_ptr<AnyProblem> problem = scene.problem(samples);
  problem->exclude({3, 20});
  for (const std::ptrdiff_t i : {20, 3}) samples.erase(samples.begin() + i);
  samples = moved(samples);
  for (int i = 0; i < problem->num_samples(); ++i) {
    const Sample& sample = samples[static_cast<std::size_t>(i)];
    const Sample paired = problem->paired(sample).value_or(sample);
    for (const MountedSensor& sensor : problem->sensors()) {
      const Observation* seen = paired.observation(sensor.mount().name);
      if (seen != nullptr && !seen->features.empty()) problem->set_measurements(i, *seen);
    }
  }
  const std::unique_ptr<AnyProblem> expected = scene.problem(samples);
  expect_same(*problem, *expected, scene.truth, scene.free());
  for (int i = 0; i < problem->num_samples(); ++i) {
    EXPECT_EQ(problem->fingerprint(i) == problem->fingerprint(0),
              expected->fingerprint(i) == expected->fingerprint(0));
  }
}

TEST(Measurements, OfAnotherKindAreRefusedAndNothingChanges) {
  const NoisyScene scene(3);
  const std::unique_ptr<AnyProblem> problem = scene.problem(scene.samples);
  const auto before = rows_of(*problem, scene.truth);
  const auto refused = [&](const auto& spoil) {
    Observation seen = moved(scene.samples)[1].observations[0];
    spoil(seen);
    try {
      problem->set_measurements(1, seen);
    } catch (const std::exception& e) {
      EXPECT_EQ(rows_of(*problem, scene.truth), before);
      return std::string(e.what());
    }
    return std::string("no error");
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused([](Observation& seen) { seen.features.pop_back(); }),
              HasSubstr("can be replaced by as many in the same frames only"));
  EXPECT_THAT(refused([](Observation& seen) { seen.features[1].point.x() = std::nan(""); }),
              HasSubstr("feature 2 is not a number"));
  EXPECT_THAT(refused([](Observation& seen) { seen.features[0].frame = "nowhere"; }),
              HasSubstr("a feature is in frame 'nowhere'"));
  EXPECT_THAT(refused([](Observation& seen) { seen.sensor = "nobody"; }),
              HasSubstr("no sensor 'nobody'"));
}

TEST(LeftOutSamples, OfALayoutLeaveNothingThatTouchesItsParameters) {
  NoisyScene scene(4);
  const std::unique_ptr<AnyProblem> problem = scene.problem(scene.samples);
  EXPECT_FALSE(problem->touched_parameters().empty());
  problem->exclude({0, 1, 2, 3});
  EXPECT_TRUE(problem->touched_parameters().empty());
  EXPECT_EQ(problem->num_samples(), 0);
  EXPECT_EQ(problem->num_residuals(), 0);
  EXPECT_EQ(normal_equations(*problem, NoisyScene::span(scene.truth), nullptr).cost, 0.0);
}

TEST(Sigma, OfABlockCanBeSetWhenSamplesHaveBeenAdded) {
  NoisyScene stated(1), estimated(1);
  stated.options = {.scale = 2.0, .sigma = 0.003, .loss = {LossType::huber, 1.0}};
  estimated.options = {.scale = 2.0, .loss = {LossType::huber, 1.0}};
  const std::vector<Sample> samples = unlike_samples(20);
  const std::unique_ptr<AnyProblem> problem = estimated.problem(samples);
  problem->set_sigma(0, 0.5);
  problem->set_sigma(0, 0.003);
  expect_same(*problem, *stated.problem(samples), stated.truth, stated.free());
  EXPECT_THROW(problem->set_sigma(0, 0.0), std::invalid_argument);
  EXPECT_THROW(problem->set_sigma(0, std::nan("")), std::invalid_argument);
}

TEST(WithoutSamples, AProblemTakesOthers) {
  NoisyScene scene(6), other(9, 5);
  const std::unique_ptr<AnyProblem> problem = scene.problem(scene.samples);
  problem->set_sigma(0, 0.002);
  const std::unique_ptr<AnyProblem> copy = problem->without_samples();
  EXPECT_EQ(copy->num_samples(), 0);
  EXPECT_EQ(copy->num_residuals(), 0);
  for (const Sample& sample : other.samples) copy->add_sample(sample);
  NoisyScene with_sigma(1);
  with_sigma.options.sigma = 0.002;
  expect_same(*copy, *with_sigma.problem(other.samples), scene.truth, scene.free());
  EXPECT_EQ(problem->num_samples(), 6);
}

}  // namespace
}  // namespace kinecal
