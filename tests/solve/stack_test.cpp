#include "kinecal/solve/stack.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/evaluation/problem.hpp"
#include "support/check_sums.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

Problem problem_of(std::span<const Sample> samples) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.scale = 2.0});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01});
  problem.add_prior("restrict", {"camera_joint", 0.0, 2.0, 3.0}, {.scale = 0.1});
  for (const Sample& sample : samples) problem.add_sample(sample);
  return problem;
}

TEST(Stack, HasTheNormalEquationsOfTheProblem) {
  const Problem empty = test::scene_problem();
  const std::vector<double> truth = test::random_values(empty.table(), 0.03, 5);
  std::vector<Sample> samples = test::exact_samples(empty, truth, 12);
  samples[4].observations[1].features[2].point.x() = std::nan("");  // the camera's
  const Problem problem = problem_of(samples);
  const FreeSet free =
      test::free_of(problem.table(), {"elbow", "camera_joint_x", "camera_joint_b", "camera_fx"});
  const std::vector<double> at = test::random_values(problem.table(), 0.01, 6);
  const Stack found = stack(problem, free, at);
  ASSERT_EQ(found.residual.size(), problem.num_residuals());
  const NormalEquations expected = normal_equations(problem, at, &free);
  NormalEquations sums = expected;
  sums.cost = 0.5 * found.residual.squaredNorm();
  sums.gradient = found.jacobian.transpose() * found.residual;
  sums.hessian = found.jacobian.transpose() * found.jacobian;
  constexpr double kSums = 1e-12;
  test::expect_same(sums, expected, kSums);
}

TEST(Stack, WeighsAFeatureByItsOwnSigma) {
  const Problem empty = test::scene_problem();
  const std::vector<double> truth = test::random_values(empty.table(), 0.03, 5);
  std::vector<Sample> samples = test::exact_samples(empty, truth, 12);
  samples[3].observations[1].features[1].sigma = 0.02;  // the camera's
  samples[7].observations[2].features[0].sigma = 5.0;   // the eye's
  const Problem problem = problem_of(samples);
  const FreeSet free = test::free_of(problem.table(), {"elbow", "camera_joint_x", "camera_fx"});
  const std::vector<double> at = test::random_values(problem.table(), 0.01, 6);
  const Stack found = stack(problem, free, at);
  NormalEquations sums = normal_equations(problem, at, &free);
  const NormalEquations expected = sums;
  sums.cost = 0.5 * found.residual.squaredNorm();
  sums.gradient = found.jacobian.transpose() * found.residual;
  sums.hessian = found.jacobian.transpose() * found.jacobian;
  constexpr double kSums = 1e-12;
  test::expect_same(sums, expected, kSums);
  const NormalEquations others =
      normal_equations(problem_of(test::exact_samples(empty, truth, 12)), at, nullptr);
  EXPECT_GT(sums.cost, 2.0 * others.cost) << "the sigma of 20 mm counts, in place of one metre";
}

/// Of estimates from noisy samples: as they spread around the truth.
TEST(Stack, HasTheCovarianceOfTheEstimates) {
  constexpr int kEstimates = 400;
  constexpr double kSigma = 1e-3;
  const std::vector<std::string> names = {"elbow", "shoulder_lift", "camera_joint_x"};
  const Problem empty = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(empty.table().size()), 0.0);
  const FreeSet free = test::free_of(empty.table(), names);
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0.0, kSigma);
  Eigen::MatrixXd found(kEstimates, 3);
  Eigen::MatrixXd expected;
  const std::vector<Sample> exact = test::exact_samples(empty, zero, 8);
  for (int n = 0; n < kEstimates; ++n) {
    Problem problem = test::scene_problem();
    problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.scale = 1.0 / kSigma});
    for (Sample sample : exact) {
      for (Feature& feature : sample.observations[0].features) {
        for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
      }
      problem.add_sample(sample);
    }
    const Stack linear = stack(problem, free, zero);  // one Gauss-Newton step
    const Eigen::MatrixXd covariance = linear.covariance().value();
    if (n == 0) expected = covariance;
    found.row(n) = -(covariance * (linear.jacobian.transpose() * linear.residual)).transpose();
  }
  const Eigen::MatrixXd spread = found.transpose() * found / kEstimates;
  // 400 estimates: a standard error of 7 % of a variance.
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(spread(i, i) / expected(i, i), 1.0, 0.3) << names[std::size_t(i)];
}

TEST(Stack, HasNoCovarianceOfWhatSamplesDoNotDetermine) {
  const Problem empty = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(empty.table().size()), 0.0);
  const Problem problem = problem_of(test::exact_samples(empty, zero, 5));
  // The torso moves camera and arm alike.
  const FreeSet free = test::free_of(problem.table(), {"elbow", "torso_joint"});
  EXPECT_FALSE(stack(problem, free, zero).covariance().has_value());
}

TEST(Stack, NamesTheSampleWhoseResidualIsNotDefined) {
  const Problem empty = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(empty.table().size()), 0.0);
  std::vector<Sample> samples = test::exact_samples(empty, zero, 3);
  for (Sample& sample : samples) sample.source = "s.yaml:7";
  const Problem problem = problem_of(samples);
  std::vector<double> backwards = zero;
  backwards[static_cast<std::size_t>(problem.table().index("head_pan"))] = 3.1;  // looks away
  try {
    (void)stack(problem, test::free_of(problem.table(), {"head_pan"}), backwards);
    FAIL() << "nothing was thrown";
  } catch (const std::domain_error& e) {
    EXPECT_STREQ(
        e.what(),
        "s.yaml:7: error block 'reprojection': the residual is not defined at these values");
  }
}

}  // namespace
}  // namespace kinecal
