#include "kinecal/trust/captures/captures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "kinecal/trust/captures/least_trimmed_squares.ipp"
#include "support/noisy_scene.hpp"
#include "support/pixel_scene.hpp"

namespace kinecal {
namespace {

/// Ruins ten samples: another LED, 5 cm off, moved while capturing, in turn.
std::vector<int> ruin_ten(test::NoisyScene& scene, unsigned seed) {
  std::vector<int> order(scene.samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  order.resize(10);
  for (std::size_t i = 0; i < order.size(); ++i) {
    Sample& sample = scene.samples[static_cast<std::size_t>(order[i])];
    std::vector<Feature>& features = sample.observations[0].features;
    if (i % 3 == 0) {
      std::swap(features[0].point, features[1].point);
    } else if (i % 3 == 1) {
      features[2].point.x() += 0.05;
    } else {
      for (double& position : sample.joint_positions) position += 0.03;
    }
  }
  std::sort(order.begin(), order.end());
  return order;
}

std::vector<int> bad_ones(const Assessment& found) {
  std::vector<int> bad;
  for (const CaptureError& error : found.captures) {
    if (error.bad) bad.push_back(error.sample);
  }
  return bad;
}

TEST(Captures, NamesTheTenThatAreRuinedAndNoOther) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    test::NoisyScene scene(100, seed);
    const std::vector<int> ruined = ruin_ten(scene, seed);
    EXPECT_EQ(bad_ones(scene.solve_and_assess()), ruined) << "seed " << seed;
  }
}

/// Joints that do not repeat, and few poses: the others fit more closely without some of them, but may foretell no better.
TEST(Captures, AreDoubtedOnlyIfTheOthersForetellBetterWithoutThem) {
  constexpr double kRepeats = 0.01;  // radians
  std::size_t by_fit = 0, doubted = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    test::NoisyScene scene(seed % 2 == 0 ? 8 : 5, seed);
    std::mt19937 random(seed + 100);
    std::normal_distribution<double> normal(0.0, kRepeats);
    for (Sample& sample : scene.samples) {
      for (double& position : sample.joint_positions) position += normal(random);
    }
    const std::vector<int> bad = bad_ones(scene.solve_and_assess());
    const std::vector<int> of_fit = bad_ones(scene.assessment({.folds = 0}));
    EXPECT_TRUE(bad.empty() || bad == of_fit);
    doubted += bad.size(), by_fit += of_fit.size();
  }
  EXPECT_GT(doubted, 0u);
  EXPECT_LT(doubted, by_fit);
}

/// 0.09 px at a sigma of 0.5 px, though nine times the noise that the other samples have.
TEST(Captures, ASampleWithinTheStatedSigmaIsNotBad) {
  const test::PixelScene within{.noise = 0.01, .sigma = 0.5, .off = 0.09};
  const JudgedResult judged = within.judged();
  EXPECT_TRUE(judged.left_out.empty());
  EXPECT_TRUE(judged.causes.empty());
  EXPECT_EQ(judged.judgement.verdict, Grade::good);
  EXPECT_FALSE(judged.assessments.back().captures[test::PixelScene::kOff].bad);
}

TEST(Captures, ASampleBeyondTheStatedSigmaIsBadIfNoNoiseExplainsIt) {
  const test::PixelScene beyond{.noise = 0.01, .sigma = 0.5, .off = 0.8};
  const JudgedResult judged = beyond.judged();
  ASSERT_EQ(judged.left_out.size(), 1u);
  EXPECT_EQ(judged.left_out[0].number, static_cast<int>(test::PixelScene::kOff) + 1);
}

/// Moves all features of some samples by the same length, in a direction of their own: a slip.
void slip(test::NoisyScene& scene, std::size_t count, double by, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::shuffle(scene.samples.begin(), scene.samples.end(), random);
  for (std::size_t s = 0; s < count; ++s) {
    const Vector3<double> direction{normal(random), normal(random), normal(random)};
    for (Feature& feature : scene.samples[s].observations[0].features) {
      feature.point += by * direction.normalized();
    }
  }
}

/// At seven times the noise, a tenth of the samples: too little for one to stand out in a fit of all.
TEST(Captures, NamesNineOfTenThatAreHardlyVisible) {
  int named = 0, clean = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    test::NoisyScene scene(100, seed);
    slip(scene, 10, 7.0 * test::kPointNoise, seed);
    for (const int bad : bad_ones(scene.solve_and_assess())) ++(bad < 10 ? named : clean);
  }
  EXPECT_GE(named, 180) << "of 200";
  EXPECT_LE(clean, 1) << "of 1800";
}

/// Samples that are off alike, because a target has slipped, pull the fit towards them.
TEST(Captures, DoNotHideEachOtherIfThreeInTenAreOffAlike) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    test::NoisyScene scene(100, seed);
    for (std::size_t s = 0; s < 30; ++s) {
      for (Feature& feature : scene.samples[s].observations[0].features) feature.point.x() += 0.02;
    }
    std::vector<int> first(30);
    std::iota(first.begin(), first.end(), 0);
    EXPECT_EQ(bad_ones(scene.solve_and_assess()), first) << seed;
  }
}

TEST(Captures, NamesNoneWhereNoneIsRuined) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    test::NoisyScene scene(50, seed);
    EXPECT_TRUE(bad_ones(scene.solve_and_assess()).empty()) << "seed " << seed;
  }
}

/// Noise of a depth camera is along its rays; a sample that is no worse than others is not left out.
TEST(Captures, NamesNoneWhereNoiseHasADirection) {
  int named = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    test::NoisyScene scene(100, seed);
    std::mt19937 random(seed + 500);
    std::normal_distribution<double> noise(0.0, 5e-3);
    for (Sample& sample : scene.samples) {
      for (Feature& feature : sample.observations[0].features) feature.point.z() += noise(random);
    }
    named += static_cast<int>(bad_ones(scene.solve_and_assess()).size());
  }
  EXPECT_LE(named, 2) << "of 2000 samples";
}

TEST(Captures, DoNotDependOnTheOrderOfSamples) {
  test::NoisyScene scene(60);
  (void)ruin_ten(scene, 3);
  const Assessment one = scene.solve_and_assess();
  std::reverse(scene.samples.begin(), scene.samples.end());
  const Assessment other = scene.solve_and_assess();
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_EQ(one.captures[i].bad, other.captures[59 - i].bad);
    EXPECT_NEAR(one.captures[i].times, other.captures[59 - i].times, 1e-6 * one.captures[i].times);
  }
}

TEST(Captures, SayWhichFeatureIsOffAndHowFarTheOthersAre) {
  test::NoisyScene scene(50);
  scene.samples[17].observations[0].features[2].point.y() += 0.048;
  const Assessment found = scene.solve_and_assess();
  EXPECT_THAT(bad_ones(found), testing::ElementsAre(17));
  const CaptureError& error = found.captures[17];
  EXPECT_EQ(error.feature.place, 2);
  EXPECT_NEAR(error.distance, 0.048, 5.0 * test::kPointNoise);
  EXPECT_LT(error.others, 5.0 * test::kPointNoise);
  EXPECT_GT(error.times, 40.0);
}

/// A third of the poses that is left out would be all of them.
TEST(LeastTrimmedSquares, OfOnePoseIsNoStep) {
  constexpr Eigen::Index kRows = 40, kSize = 3;
  LinearFit fit;
  fit.blocks = {{0, 0, 0, kRows}};
  fit.residual = Eigen::VectorXd::Random(kRows);
  fit.jacobian = LinearFit::RowMajor::Random(kRows, kSize);
  fit.loss = Eigen::VectorXd::Ones(kRows);
  fit.coordinates.basis = Eigen::MatrixXd::Identity(kSize, kSize);
  fit.prior_gradient = Eigen::VectorXd::Zero(kSize);
  fit.prior_hessian = Eigen::MatrixXd::Zero(kSize, kSize);
  EXPECT_EQ(detail::least_trimmed_squares(fit, each_its_own(1)).norm(), 0.0);
}

TEST(Captures, HaveTheInfluenceThatLeavingThemOutHas) {
  test::NoisyScene scene(15);
  scene.samples[4].observations[0].features[0].point.x() += 0.005;
  scene.solve();
  const auto evaluator = scene.solved().evaluator(scene.free());
  const LinearFit fit = scene.linear(*evaluator);
  const std::vector<CaptureError> captures =
      capture_errors(scene.solved(), fit, each_its_own(scene.samples.size()));
  const Eigen::MatrixXd hessian = information(fit, fit.loss);
  const double noise = fit.residual.norm() / std::sqrt(180.0 - 10.0);
  for (const std::size_t sample : {0u, 4u, 9u}) {
    const Eigen::VectorXd moved = scene.values_without({sample}) - scene.values();
    const Eigen::VectorXd of_free = moved(scene.free().parameters());
    const Eigen::VectorXd z = fit.coordinates.basis.colPivHouseholderQr().solve(of_free);
    const double expected = std::sqrt(z.dot(hessian * z) / 10.0) / noise;
    EXPECT_NEAR(captures[sample].influence, expected, 0.01 * expected + 1e-6);
  }
}

}  // namespace
}  // namespace kinecal
