#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// Position of the hand in the camera's frame in a sample, by the oracle.
Vector3<double> hand_in_camera(const Sample& sample, const Eigen::VectorXd& values) {
  const auto scene = test::scene_problem();
  const auto at = [&](std::size_t sensor, const char* frame) {
    return test::tip_pose(scene, sensor, frame, sample, test::NoisyScene::span(values));
  };
  return (at(1, "camera_optical_frame").inverse() * at(0, "hand")).translation;
}

TEST(PoseUncertainty, IsThatOfTheOraclesDifferences) {
  test::NoisyScene scene(20);
  const Assessment found = scene.solve_and_assess();
  const Eigen::VectorXd values = scene.values();
  double variances = 0.0;
  for (const Sample& sample : scene.samples) {
    Eigen::MatrixXd jacobian(3, std::ssize(found.parameters));
    constexpr double kStep = 1e-6;
    for (std::size_t c = 0; c < found.parameters.size(); ++c) {
      Eigen::VectorXd plus = values, minus = values;
      plus(found.parameters[c]) += kStep;
      minus(found.parameters[c]) -= kStep;
      jacobian.col(static_cast<int>(c)) =
          (hand_in_camera(sample, plus) - hand_in_camera(sample, minus)) / (2.0 * kStep);
    }
    variances += (jacobian * found.uncertainty.covariance.matrix() * jacobian.transpose()).trace();
  }
  ASSERT_FALSE(found.compared.empty());
  EXPECT_EQ(found.compared[0].frame, "hand");
  EXPECT_EQ(found.compared[0].in, "camera_optical_frame");
  EXPECT_NEAR(found.compared[0].position, std::sqrt(variances / 20.0),
              1e-6 * found.compared[0].position);
  EXPECT_GE(found.compared[0].worst_position, found.compared[0].position);
  EXPECT_TRUE(found.compared[0].determined);
}

TEST(PoseUncertainty, CoversTheTrueErrorOfTheHand) {
  // sqrt(trace) is the root mean square of the error's length: over many runs the squared error is
  // as large as the variance.
  double ratio = 0.0;
  constexpr int kRuns = 60;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    test::NoisyScene scene(20, seed);
    const Assessment found = scene.solve_and_assess();
    double squares = 0.0;
    for (const Sample& sample : scene.samples) {
      squares += (hand_in_camera(sample, scene.values()) - hand_in_camera(sample, scene.truth))
                     .squaredNorm();
    }
    ratio += squares / 20.0 / (found.compared[0].position * found.compared[0].position) / kRuns;
  }
  EXPECT_NEAR(ratio, 1.0, 0.25);
}

TEST(PoseUncertainty, SaysWhereADirectionThatNothingDeterminesMovesThePose) {
  test::NoisyScene scene(10);
  scene.names.push_back("shoulder_pan");
  scene.names.push_back("head_pan_c");
  const Assessment found = scene.solve_and_assess();
  EXPECT_TRUE(found.compared[0].determined);  // both turn together
  const auto evaluator = scene.solved().evaluator(scene.free());
  const LinearFit fit = scene.linear(*evaluator);
  const Eigen::VectorXd values = scene.values();
  const PoseUncertainty in_base =
      pose_uncertainty(scene.solved(), scene.free(), scene.span(values), fit, found.uncertainty,
                       scene.samples, {"hand"}, {"base_link"});
  EXPECT_FALSE(in_base.determined);
  EXPECT_THROW((void)pose_uncertainty(scene.solved(), scene.free(), scene.span(values), fit,
                                      found.uncertainty, scene.samples, {"hnd"}, {"base_link"}),
               RobotError);
}

}  // namespace
}  // namespace kinecal
