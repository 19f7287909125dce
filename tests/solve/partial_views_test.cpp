// Two cameras that see different parts of one target: calibrated as one sample.
#include <gtest/gtest.h>

#include <random>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// Arm, depth camera and eye with injected errors; six features with ids in each sample.
class PartialViews : public testing::Test {
 protected:
  PartialViews() : truth_(test::scene_table().values()) {
    const auto scene = test::scene_problem();
    const std::vector<double> far = test::random_values(scene.table(), 0.05, 7);
    for (const std::string& name : test::kNoisyFree) {
      const int i = scene.table().index(name);
      truth_(i) = far[static_cast<std::size_t>(i)];
    }
    samples_ = test::exact_samples(scene, test::NoisyScene::span(truth_), 30, "hand", 1, 6);
    for (Sample& sample : samples_) {
      for (Observation& seen : sample.observations) {
        for (int i = 0; i < 6; ++i) seen.features[static_cast<std::size_t>(i)].id = 100 + i;
      }
    }
  }
  [[nodiscard]] Eigen::VectorXd solution(const std::vector<Sample>& samples) const {
    Problem problem = test::scene_problem();
    problem.add_block("points", PointToPoint{}, {"camera", "arm"}, {.scale = 1e3});
    problem.add_block("pixels", PointToPixel{}, {"arm", "eye"});
    for (const Sample& sample : samples) problem.add_sample(sample);
    Eigen::VectorXd values = test::scene_table().values();
    EXPECT_TRUE(solve(problem, test::free_of(problem.table(), test::kNoisyFree), values).converged);
    return values;
  }

  Eigen::VectorXd truth_;
  std::vector<Sample> samples_;
};

/// Each camera with what it saw as a sample of its own.
std::vector<Sample> split_by_hand(const std::vector<Sample>& samples) {
  std::vector<Sample> split;
  for (const Sample& sample : samples) {
    for (const std::size_t camera : {1u, 2u}) {
      Sample part = sample;
      part.observations = {{"arm", {}}, sample.observations[camera]};
      for (const Feature& seen : sample.observations[camera].features) {
        for (const Feature& held : sample.observations[0].features) {
          if (held.id == seen.id) part.observations[0].features.push_back(held);
        }
      }
      for (Observation& observation : part.observations) {
        for (Feature& feature : observation.features) feature.id.reset();
      }
      split.push_back(part);
    }
  }
  return split;
}

TEST_F(PartialViews, GiveTheInjectedErrorsAsSamplesThatWereSplitByHandDo) {
  std::mt19937 random(3);
  for (Sample& sample : samples_) {
    std::vector<Observation>& seen = sample.observations;
    for (Observation& observation : seen) {
      std::shuffle(observation.features.begin(), observation.features.end(), random);
    }
    seen[1].features.resize(4);
    seen[2].features.resize(3);
  }
  constexpr double kRecovered = 1e-7, kSame = 1e-9;
  const Eigen::VectorXd found = solution(samples_);
  EXPECT_LE((found - truth_).lpNorm<Eigen::Infinity>(), kRecovered);
  EXPECT_LE((found - solution(split_by_hand(samples_))).lpNorm<Eigen::Infinity>(), kSame);
}

}  // namespace
}  // namespace kinecal
