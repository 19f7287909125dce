#include "kinecal/solve/linear_fit.hpp"

#include <gtest/gtest.h>

#include "kinecal/solve/spectrum.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(LinearFit, HasTheNormalEquationsOfTheProblem) {
  test::NoisyScene scene(10);
  scene.options.loss = {LossType::huber, 1.0};
  scene.solve();
  const FreeSet free = scene.free();
  const auto evaluator = scene.solved().evaluator(free);
  const LinearFit fit = scene.linear(*evaluator);
  const Eigen::VectorXd values = scene.values();
  const NormalEquations normal = normal_equations(scene.solved(), scene.span(values), &free);
  const Eigen::MatrixXd& basis = fit.coordinates.basis;
  const Eigen::MatrixXd expected = basis.transpose() * normal.hessian * basis;
  EXPECT_LT((information(fit, fit.loss) - expected).norm(), 1e-10 * expected.norm());
  EXPECT_EQ(fit.blocks.size(), 10u);
  EXPECT_EQ(fit.residual.size(), 120);
}

TEST(LinearFit, RefitsAsASolverWouldWithoutSomeSamples) {
  test::NoisyScene scene(12);
  scene.solve();
  const auto evaluator = scene.solved().evaluator(scene.free());
  const LinearFit fit = scene.linear(*evaluator);
  Eigen::VectorXd weights = fit.loss;
  for (const RowBlock& block : fit.blocks) {
    if (block.sample % 3 == 0) weights.segment(block.first, block.size).setZero();
  }
  const Eigen::VectorXd values = scene.values();
  const Eigen::VectorXd first = step_to_minimum(fit, weights);
  const Refit refitted = refit(*evaluator, scene.span(values), fit, weights, first, 1.0, 1e-14);
  const Eigen::VectorXd expected = scene.values_without({0, 3, 6, 9});
  EXPECT_LT((refitted.values - expected).norm(), 1e-7 * expected.norm());
}

TEST(LinearFit, SumsAreThoseOfTheRowsThatAreLeft) {
  test::NoisyScene scene(12);
  scene.options.loss = {LossType::huber, 1.0};
  scene.solve();
  const auto evaluator = scene.solved().evaluator(scene.free());
  const LinearFit fit = scene.linear(*evaluator);
  EXPECT_EQ((fit.hessian - information(fit, fit.loss)).norm(), 0.0);
  std::vector<int> part;
  for (int s = 0; s < 12; ++s) part.push_back(s % 4 - 1);  // a quarter is in none
  const std::vector<RowSums> without = sums_without_parts(fit, fit.loss, part);
  ASSERT_EQ(without.size(), 3u);
  for (int p = 0; p < 3; ++p) {
    Eigen::VectorXd weights = fit.loss;
    for (const RowBlock& block : fit.blocks) {
      if (part[static_cast<std::size_t>(block.sample)] != p) continue;
      weights.segment(block.first, block.size).setZero();
    }
    constexpr double kRounding = 1e-12;
    const RowSums& of = without[static_cast<std::size_t>(p)];
    const Eigen::MatrixXd expected = information(fit, weights, 0.0);
    EXPECT_LT((of.information - expected).norm(), kRounding * expected.norm());
    const Eigen::VectorXd step = step_to_minimum(fit, weights, 0.5);
    EXPECT_LT((step_to_minimum(fit, of, 0.5) - step).norm(), 1e-9 * step.norm());
  }
}

TEST(Spectrum, InvertsWhatIsNotSingularInAnyUnits) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Random(20, 4);
  j.col(1) *= 1e6;
  j.col(2) *= 1e-6;
  const Eigen::MatrixXd a = j.transpose() * j;
  const detail::Spectrum regular(a);
  EXPECT_EQ(regular.null, 0);
  const Eigen::MatrixXd product = a * regular.pseudo_inverse();
  EXPECT_LT((product.diagonal() - Eigen::VectorXd::Ones(4)).norm(), 1e-9);
  j.col(3) = 1e-6 * j.col(1) + 3.0 * j.col(0);
  const detail::Spectrum singular(j.transpose() * j);
  EXPECT_EQ(singular.null, 1);
  const detail::Spectrum nothing(Eigen::MatrixXd::Zero(3, 3));
  EXPECT_EQ(nothing.null, 3);
  EXPECT_EQ(nothing.pseudo_inverse().norm(), 0.0);
}

}  // namespace
}  // namespace kinecal
