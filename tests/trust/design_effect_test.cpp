#include "kinecal/trust/design_effect.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

double effect_in(test::NoisyScene& scene) {
  const auto evaluator = scene.solved().evaluator(scene.free());
  return design_effect(scene.solved(), scene.linear(*evaluator));
}

TEST(DesignEffect, IsOneIfFeaturesErrIndependently) {
  int more = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    test::NoisyScene scene(25, seed);
    scene.solve();
    more += effect_in(scene) > 1.0;
  }
  EXPECT_LE(more, 1);
}

TEST(DesignEffect, IsTheNumberOfCopiesOfEachFeature) {
  double sum = 0.0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    test::NoisyScene scene(40, seed);
    for (Sample& sample : scene.samples) {
      for (Observation& seen : sample.observations) {
        const std::vector<Feature> once = seen.features;
        for (int copy = 1; copy < 6; ++copy) {
          seen.features.insert(seen.features.end(), once.begin(), once.end());
        }
      }
    }
    scene.solve();
    sum += effect_in(scene);
  }
  EXPECT_NEAR(sum / 20.0, 6.0, 0.4);
}

/// Joints that stop elsewhere than they report, each time.
void disturb(test::NoisyScene& scene, unsigned seed) {
  std::mt19937 random(seed + 5000);
  std::normal_distribution<double> joint(0.0, 4e-3);
  for (Sample& sample : scene.samples) {
    for (double& position : sample.joint_positions) position += joint(random);
  }
}

TEST(DesignEffect, MakesUncertaintyCoverTheTruthOfJointsThatDoNotRepeat) {
  int inside = 0, without = 0, all = 0;
  for (unsigned run = 0; run < 60; ++run) {
    test::NoisyScene scene(40, run);
    disturb(scene, run);
    const Assessment found = scene.solve_and_assess({.folds = 0});
    const double effect = found.uncertainty.design_effect;
    EXPECT_GT(effect, 1.0);
    for (std::size_t c = 0; c < found.parameters.size(); ++c, ++all) {
      const int p = found.parameters[c];
      const double error = std::abs(scene.result.table[p].value - scene.truth(p));
      const double deviation = found.uncertainty.deviation(static_cast<int>(c));
      inside += error < 1.96 * deviation;
      without += error < 1.96 * deviation / std::sqrt(effect);
    }
  }
  const auto share = [&](int count) { return static_cast<double>(count) / all; };
  EXPECT_GT(share(inside), 0.90);
  EXPECT_LT(share(inside), 0.98);
  EXPECT_LT(share(without), 0.85);
}

}  // namespace
}  // namespace kinecal
