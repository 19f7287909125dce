#include "kinecal/trust/noise/sample_slopes.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal::test {
namespace {

TEST(MeasurementSlopes, AreThoseOfSamplesThatAreAddedAnew) {
  NoisyScene scene(9);
  scene.solve();
  const FreeSet free = scene.free();
  const auto evaluator = scene.solved().evaluator(free);
  const LinearFit fit = scene.linear(*evaluator);
  const Eigen::VectorXd values = scene.values();
  const detail::FittedSamples fitted{scene.solved(), free, fit, NoisyScene::span(values),
                                     scene.samples};
  detail::MeasurementSlopes slopes(fitted);
  constexpr double kStep = 1e-6;
  for (const char* sensor : {"arm", "camera", "arm"}) {  // the first move leaves nothing behind
    const auto move = [](Observation& seen) {
      for (Feature& feature : seen.features) feature.point *= 1.0 + kStep;
    };
    const auto move_sample = [&](Sample& sample) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor == sensor) move(seen);
      }
    };
    const Eigen::VectorXd expected = detail::sample_slopes(fitted, move_sample, kStep);
    EXPECT_GT(expected.norm(), 0.0) << sensor;
    EXPECT_EQ((slopes(sensor, move, kStep) - expected).norm(), 0.0) << sensor;
  }
  const auto blind = [](Observation& seen) { seen.features.clear(); };
  EXPECT_EQ(slopes("camera", blind, kStep).norm(), 0.0);
  EXPECT_EQ(slopes("nothing", blind, kStep).norm(), 0.0);
}

}  // namespace
}  // namespace kinecal::test
