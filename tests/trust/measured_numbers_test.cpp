#include "kinecal/trust/measured_numbers.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal::test {
namespace {

int numbers_of(const NoisyScene& scene) {
  const Eigen::VectorXd values = scene_table().values();
  return measured_numbers(*scene.problem(scene.samples), NoisyScene::span(values));
}

TEST(MeasuredNumbers, AreSixForABodyHoweverManyPointsItHas) {
  EXPECT_EQ(numbers_of(NoisyScene(5)), 5 * 6) << "of four points each";
}

TEST(MeasuredNumbers, AreThoseOfThePointsIfTheyAreFewer) {
  NoisyScene scene(5);
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) seen.features.resize(1);
  }
  EXPECT_EQ(numbers_of(scene), 5 * 3);
}

}  // namespace
}  // namespace kinecal::test
