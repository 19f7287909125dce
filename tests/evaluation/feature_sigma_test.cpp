// Features with a standard deviation of their own: their weight, in every sum and row.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "kinecal/errors.hpp"
#include "support/oracle_problem.hpp"
#include "support/scene.hpp"
#include "support/sums.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

constexpr double kHandEye = 0.01, kPixels = 2.0;  // sigmas of the blocks, metres and pixels

TermOptions options_of(double sigma, const Loss& loss = {}) {
  return {.scale = 3.0, .sigma = sigma, .loss = loss};
}

/// Points and pixels with errors of a few centimetres and pixels.
std::vector<Sample> noisy_samples(int count) {
  const Problem problem = test::scene_problem();
  const std::vector<double> truth = test::random_values(problem.table(), 0.02, 5);
  std::vector<Sample> samples = test::exact_samples(problem, truth, count);
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      for (Feature& feature : seen.features) {
        const double size = seen.sensor == "eye" ? 3.0 : 0.02;
        feature.point.x() += size * noise(random);
        feature.point.y() += size * noise(random);
      }
    }
  }
  samples[1].observations[1].features[2].point.x() = std::nan("");
  return samples;
}

/// Gives every feature of a sensor a sigma.
void set_sigmas(std::vector<Sample>& samples, std::size_t sensor, double sigma) {
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[sensor].features) feature.sigma = sigma;
  }
}

/// Blocks of all kinds that are summed in their own way: a difference, jets, pixels.
template <class P>
void add_blocks(P& problem, double hand_eye, double pixels, const Loss& loss) {
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, options_of(hand_eye, loss));
  problem.add_block("ground", PointToPlane(0, 0, 1, 0.1), {"camera"}, options_of(hand_eye, loss));
  problem.add_block("pixels", PointToPixel{}, {"arm", "eye"}, options_of(pixels, loss));
}

template <class S>
BasicProblem<S> problem_of(std::span<const Sample> samples, double hand_eye, double pixels,
                           const Loss& loss = {}) {
  BasicProblem<S> problem = test::scene_problem<S>();
  add_blocks(problem, hand_eye, pixels, loss);
  for (const Sample& sample : samples) problem.add_sample(sample);
  return problem;
}

template <class S>
class FeatureSigma : public testing::Test {};
using Scalars = testing::Types<double, Packet>;
TYPED_TEST_SUITE(FeatureSigma, Scalars);

TYPED_TEST(FeatureSigma, OfAllFeaturesIsThatOfTheBlock) {
  using S = TypeParam;
  constexpr double kMetres = 0.003, kPixel = 0.7;
  std::vector<Sample> samples = noisy_samples(2 * kLanes<S> + 1);
  for (const Loss& loss : {Loss{}, Loss{LossType::huber, 2.0}, Loss{LossType::cauchy, 1.0}}) {
    const auto of_blocks = problem_of<S>(samples, kMetres, kPixel, loss);
    std::vector<Sample> with_sigmas = samples;
    set_sigmas(with_sigmas, 1, kMetres);  // the camera's points
    set_sigmas(with_sigmas, 2, kPixel);   // the eye's pixels
    const auto of_features = problem_of<S>(with_sigmas, kHandEye, kPixels, loss);
    const std::vector<double> at = test::random_values(of_blocks.table(), 0.03, 8);
    const FreeSet free = test::all_free(of_blocks.table());
    const NormalEquations expected = normal_equations(of_blocks, at, &free);
    test::expect_same(normal_equations(of_features, at, &free), expected, 1e-12);
    EXPECT_NEAR(normal_equations(of_features, at, nullptr).cost, expected.cost,
                1e-12 * expected.cost);
  }
}

/// Some features have one, of either sensor or of both; samples with and without share no batch.
TYPED_TEST(FeatureSigma, OfSomeFeaturesWeighsAsTheOracleDoes) {
  using S = TypeParam;
  std::vector<Sample> samples = noisy_samples(3 * kLanes<S> + 2);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> size(0.2, 4.0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (n % 5 == 4) continue;
    auto& seen = samples[n].observations;
    for (std::size_t i = 0; i < 4; ++i) {
      if ((n + i) % 2 == 0) seen[0].features[i].sigma = 0.01 * size(random);
      if (i < 3) seen[1].features[i].sigma = 0.01 * size(random);
      if (i > 1) seen[2].features[i].sigma = size(random);
    }
  }
  for (const Loss& loss : {Loss{}, Loss{LossType::huber, 2.0}}) {
    const auto problem = problem_of<S>(samples, kHandEye, kPixels, loss);
    test::OracleProblem oracle = test::oracle_of(problem);
    add_blocks(oracle, kHandEye, kPixels, loss);
    for (const Sample& sample : samples) oracle.add_sample(sample);
    const std::vector<double> at = test::random_values(problem.table(), 0.03, 8);
    const FreeSet free = test::all_free(problem.table());
    const test::OracleRows expected = oracle.rows(at), found = test::rows_of(problem, at, &free);
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [key, rows] : expected) {
      EXPECT_LE((found.at(key).factor - rows.factor).norm(), 1e-14 * rows.factor.norm());
    }
    const NormalEquations sums = oracle.multiplied_out(expected, at, free);
    test::expect_same(normal_equations(problem, at, &free), sums, 1e-10);
    EXPECT_NEAR(normal_equations(problem, at, nullptr).cost, sums.cost, 1e-10 * sums.cost);
  }
}

TEST(FeatureSigma, OfAPointCountsInMetresAndNotForPixels) {
  std::vector<Sample> samples = noisy_samples(5);
  const Problem without = problem_of<Packet>(samples, kHandEye, kPixels);
  set_sigmas(samples, 0, kHandEye);  // that of the block: only pixels could differ
  const Problem with = problem_of<Packet>(samples, kHandEye, kPixels);
  const std::vector<double> at = test::random_values(with.table(), 0.03, 8);
  const FreeSet free = test::all_free(with.table());
  test::expect_same(normal_equations(with, at, &free), normal_equations(without, at, &free), 1e-13);
}

std::string message_of(Problem& problem, const Sample& sample) {
  return test::thrown<SampleError>([&] { problem.add_sample(sample); }, "no error");
}

TEST(FeatureSigma, MustBePositiveAndFinite) {
  Problem problem = test::scene_problem();
  add_blocks(problem, kHandEye, kPixels, {});
  Sample sample = noisy_samples(2)[0];
  for (const double wrong : {0.0, -0.5, std::nan(""), HUGE_VAL}) {
    sample.observations[1].features[2].sigma = wrong;
    EXPECT_THAT(message_of(problem, sample),
                HasSubstr("scene:0: sensor 'camera': the sigma of feature 3 must be positive and "
                          "finite, is "));
  }
  sample.observations[1].features[2].sigma = -0.5;
  EXPECT_THAT(message_of(problem, sample), HasSubstr("is -0.5"));
  EXPECT_EQ(problem.num_samples(), 0);
}

TEST(FeatureSigma, IsRefusedByABlockOfPlanes) {
  Problem problem = test::scene_problem();
  problem.add_block("planes", PlaneToPlane{}, {"camera", "arm"});
  Sample sample = noisy_samples(2)[0];
  EXPECT_EQ(message_of(problem, sample), "no error");
  sample.observations[0].features[1].sigma = 0.01;
  EXPECT_THAT(message_of(problem, sample),
              HasSubstr("scene:0: error block 'planes': a feature of sensor 'arm' has a sigma"));
}

}  // namespace
}  // namespace kinecal
