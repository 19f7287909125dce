#include "kinecal/solve/compressed_cost.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

/// Residuals and Jacobian of all samples on top of one another, weighted, without losses.
struct Stacked {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

Stacked stack(const Problem& problem, std::span<const double> values, const FreeSet& free) {
  Stacked all;
  all.jacobian.resize(0, free.size());
  (void)evaluate(problem, values, &free, [&](int t, int, const TermResiduals& out) {
    const double weight = problem.term(t).weight;
    const Eigen::Index rows = all.residual.size();
    all.residual.conservativeResize(rows + out.residual.size());
    all.jacobian.conservativeResize(rows + out.residual.size(), Eigen::NoChange);
    all.residual.tail(out.residual.size()) = weight * out.residual;
    all.jacobian.bottomRows(out.residual.size()) = weight * out.jacobian;
  });
  return all;
}

Problem noisy_problem(const Loss& loss) {
  Problem problem = test::scene_problem();
  TermOptions options;
  options.scale = 3.0;
  options.loss = loss;
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, options);
  options.scale = 0.01;
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, options);
  const auto truth = test::random_values(problem.table(), 0.01, 2);
  for (const Sample& sample : test::exact_samples(problem, truth, 6)) problem.add_sample(sample);
  return problem;
}

FreeSet all_free(const Problem& problem) {
  std::vector<int> all;
  for (int i = 0; i < problem.table().size(); ++i) all.push_back(i);
  return FreeSet(all, problem.table().size());
}

/// Turns of a frame about its only point have columns of rounding, which are in no direction.
TEST(CompressedCost, TakesColumnsOfRoundingForZero) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(20, 4);
  const Eigen::VectorXd residual = Eigen::VectorXd::Random(20);
  jacobian.col(2) *= 1e-17;
  const auto equivalent = [&](const Eigen::MatrixXd& of) {
    NormalEquations normal(static_cast<int>(of.cols()));
    normal.cost = 0.5 * residual.squaredNorm();
    normal.gradient = of.transpose() * residual;
    normal.hessian = of.transpose() * of;
    return detail::EquivalentResidual(normal);
  };
  const detail::EquivalentResidual found = equivalent(jacobian);
  EXPECT_LE(found.jacobian.col(2).norm(), 1e-15);
  const std::vector<Eigen::Index> others = {0, 1, 3};
  const detail::EquivalentResidual expected = equivalent(jacobian(Eigen::all, others));
  EXPECT_NEAR(found.residual.head(4).norm(), expected.residual.head(3).norm(), 1e-12);
  EXPECT_NEAR(found.residual.norm(), residual.norm(), 1e-12);
}

TEST(CompressedCost, HasTheCostGradientAndHessianOfTheStackedResiduals) {
  const Problem problem = noisy_problem({});
  const FreeSet free = all_free(problem);
  const auto x = test::random_values(problem.table(), 0.02, 5);
  const Stacked all = stack(problem, x, free);
  const detail::EquivalentResidual compressed(normal_equations(problem, x, &free));
  EXPECT_EQ(compressed.residual.size(), free.size() + 1);
  EXPECT_NEAR(compressed.residual.squaredNorm() / all.residual.squaredNorm(), 1.0, 1e-12);
  const Eigen::VectorXd gradient = all.jacobian.transpose() * all.residual;
  EXPECT_LE((compressed.jacobian.transpose() * compressed.residual - gradient).norm(),
            1e-10 * gradient.norm());
  const Eigen::MatrixXd hessian = all.jacobian.transpose() * all.jacobian;
  EXPECT_LE((compressed.jacobian.transpose() * compressed.jacobian - hessian).norm(),
            1e-10 * hessian.norm());  // directions below kNoCurvature are left out
}

/// The problem above frees parameters that its samples cannot separate: its Hessian is singular.
TEST(CompressedCost, IsFiniteWhereTheHessianIsSingular) {
  const Problem problem = noisy_problem({});
  const FreeSet free = all_free(problem);
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  const NormalEquations normal = normal_equations(problem, zero, &free);
  const Eigen::VectorXd d =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(normal.hessian).eigenvalues();
  ASSERT_LT(d(0), 1e-12 * d(d.size() - 1));
  const detail::EquivalentResidual compressed(normal);
  EXPECT_TRUE(compressed.residual.allFinite());
  EXPECT_TRUE(compressed.jacobian.allFinite());
}

TEST(CompressedCost, ItsGaussNewtonStepSolvesTheNormalEquations) {
  const Problem problem = noisy_problem({});
  const FreeSet all = all_free(problem);
  const auto x = test::random_values(problem.table(), 0.02, 5);
  for (const bool singular : {false, true}) {
    const std::vector<int> some = {1, 2, 3, 4, 6, 13, 14, 15};  // joints and the camera's position
    const FreeSet free = singular ? all : FreeSet(some, problem.table().size());
    const NormalEquations normal = normal_equations(problem, x, &free);
    const detail::EquivalentResidual at(normal);
    const detail::GaussNewtonStep found = detail::gauss_newton_step(at);
    const double promised = 0.5 * at.residual.head(free.size()).squaredNorm();
    const double falls =
        -normal.gradient.dot(found.step) - 0.5 * found.step.dot(normal.hessian * found.step);
    // The equivalent residual leaves out directions almost without curvature, the Hessian has them.
    const double rounding = singular ? 1e-3 : 1e-6;
    EXPECT_NEAR(falls + found.left, promised, rounding * promised) << singular;
    EXPECT_LE(found.left, (singular ? 1e-2 : 1e-6) * promised);
    EXPECT_GE(found.left, 0.0);
  }
}

/// The gradient of the cost with a loss, by central differences of the cost itself.
TEST(CompressedCost, GradientWithALossIsThatOfTheRobustCost) {
  for (const LossType type : {LossType::huber, LossType::cauchy, LossType::tukey}) {
    const Problem problem = noisy_problem({type, 0.3});
    const FreeSet free = all_free(problem);
    const auto x = test::random_values(problem.table(), 0.02, 5);
    Evaluator<Packet> evaluator(problem, free);
    const detail::CompressedCost cost(evaluator, Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                                     x.data(), problem.table().size())));
    const auto n = static_cast<Eigen::Index>(free.size());
    const auto cost_at = [&](const std::vector<double>& values) {
      Eigen::VectorXd r(n + 1);
      const double* blocks[] = {values.data()};
      EXPECT_TRUE(cost.Evaluate(blocks, r.data(), nullptr));
      return 0.5 * r.squaredNorm();
    };
    Eigen::VectorXd r(n + 1);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(n + 1, n);
    const double* blocks[] = {x.data()};
    double* jacobians[] = {jacobian.data()};
    ASSERT_TRUE(cost.Evaluate(blocks, r.data(), jacobians));
    const double sum_of_rho = normal_equations(problem, x, nullptr).cost;
    EXPECT_NEAR(0.5 * r.squaredNorm(), sum_of_rho, 1e-12 * sum_of_rho);
    const Eigen::VectorXd gradient = jacobian.transpose() * r;
    for (Eigen::Index i = 0; i < n; ++i) {
      constexpr double kStep = 1e-6;
      std::vector<double> up = x, down = x;
      up[static_cast<std::size_t>(i)] += kStep;
      down[static_cast<std::size_t>(i)] -= kStep;
      const double numeric = (cost_at(up) - cost_at(down)) / (2 * kStep);
      EXPECT_NEAR(gradient(i), numeric, 1e-7 * gradient.norm())
          << problem.table()[static_cast<int>(i)].name;
    }
  }
}

/// Calls a cost, with a Jacobian or without.
class Calls {
 public:
  explicit Calls(const detail::CompressedCost& cost)
      : cost_(cost), r_(cost.num_residuals()), j_(r_.size() * (r_.size() - 1)) {}

  bool operator()(const std::vector<double>& x, bool derivatives) {
    const double* blocks[] = {x.data()};
    double* jacobians[] = {j_.data()};
    return cost_.Evaluate(blocks, r_.data(), derivatives ? jacobians : nullptr);
  }
  [[nodiscard]] const Eigen::VectorXd& residual() const { return r_; }

 private:
  const detail::CompressedCost& cost_;
  Eigen::VectorXd r_, j_;
};

TEST(CompressedCost, EvaluatesSamplesOnceWhereCostAndJacobianAreAskedFor) {
  const Problem problem = noisy_problem({});
  const FreeSet free = all_free(problem);
  Evaluator<Packet> evaluator(problem, free);
  const detail::CompressedCost cost(evaluator, Eigen::VectorXd::Zero(problem.table().size()));
  Calls call(cost);
  const auto x = test::random_values(problem.table(), 0.02, 5);
  const auto y = test::random_values(problem.table(), 0.02, 6);
  EXPECT_TRUE(std::isinf(cost.promised_decrease()));
  ASSERT_TRUE(call(x, false));
  EXPECT_TRUE(std::isinf(cost.promised_decrease())) << "no step starts there yet";
  ASSERT_TRUE(call(x, true));
  EXPECT_EQ(cost.evaluations(), 1);
  const double promised = cost.promised_decrease();
  const Eigen::VectorXd at_x = call.residual();
  ASSERT_TRUE(call(y, false));
  EXPECT_EQ(cost.evaluations(), 2);
  EXPECT_NE(call.residual(), at_x);
  EXPECT_EQ(cost.promised_decrease(), promised) << "a step to there may be refused";
  ASSERT_TRUE(call(x, true));
  EXPECT_EQ(cost.evaluations(), 3);
  EXPECT_EQ(call.residual(), at_x);
  EXPECT_EQ(cost.promised_decrease(), promised);
}

TEST(CompressedCost, FailsWhereTheCostIsNotFiniteAndKeepsNothingOfIt) {
  const Problem problem = noisy_problem({});
  const FreeSet free = all_free(problem);
  Evaluator<Packet> evaluator(problem, free);
  const detail::CompressedCost cost(evaluator, Eigen::VectorXd::Zero(problem.table().size()));
  Calls call(cost);
  const auto x = test::random_values(problem.table(), 0.02, 5);
  const std::vector<double> nowhere(x.size(), std::numeric_limits<double>::quiet_NaN());
  ASSERT_TRUE(call(x, true));
  const Eigen::VectorXd at_x = call.residual();
  EXPECT_FALSE(call(nowhere, false));
  EXPECT_FALSE(call(nowhere, true));
  ASSERT_TRUE(call(x, false));
  EXPECT_EQ(call.residual(), at_x);
}

/// Columns that nearly depend on others, as those of a lens do: the gradient stays that of the samples.
TEST(EquivalentResidual, KeepsTheGradientWhereColumnsAreNearlyDependent) {
  constexpr int kRows = 60, kColumns = 12;
  std::srand(1);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(kRows, kColumns);
    for (int c = 4; c < kColumns; ++c) {
      const double apart = std::pow(10.0, -3.0 - 0.5 * (c % 8));
      jacobian.col(c) = jacobian.leftCols(4) * Eigen::VectorXd::Random(4) +
                        apart * Eigen::VectorXd::Random(kRows);
      jacobian.col(c) *= std::pow(10.0, c % 5);
    }
    const Eigen::VectorXd residual = Eigen::VectorXd::Random(kRows);
    NormalEquations normal(kColumns);
    normal.cost = 0.5 * residual.squaredNorm();
    normal.gradient = jacobian.transpose() * residual;
    normal.hessian = jacobian.transpose() * jacobian;
    const detail::EquivalentResidual same(normal);
    const Eigen::VectorXd scale = normal.hessian.diagonal().cwiseSqrt();
    const Eigen::VectorXd lost =
        (same.jacobian.transpose() * same.residual - normal.gradient).cwiseQuotient(scale);
    constexpr double kRounding =
        3e-6;  // a direction of curvature 1e-13 may be left out: sqrt of it, times |r|
    EXPECT_LE(lost.cwiseAbs().maxCoeff(), kRounding) << trial;
    const Eigen::MatrixXd apart = scale.cwiseInverse().asDiagonal() *
                                  (same.jacobian.transpose() * same.jacobian - normal.hessian) *
                                  scale.cwiseInverse().asDiagonal();
    EXPECT_LE(apart.cwiseAbs().maxCoeff(), 1e-12) << trial;
  }
}

}  // namespace
}  // namespace kinecal
