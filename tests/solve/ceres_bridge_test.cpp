#include "kinecal/solve/ceres_bridge.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/solver.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/solve/solve.hpp"
#include "support/scene.hpp"
#include "support/sums.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;

constexpr double kSums = 1e-11;

std::vector<Sample> samples() {
  const Problem empty = test::scene_problem();
  std::vector<double> truth(static_cast<std::size_t>(empty.table().size()), 0.0);
  for (const char* name : {"elbow", "wrist", "camera_joint_x", "camera_joint_a", "camera_fx"}) {
    truth[static_cast<std::size_t>(empty.table().index(name))] = 0.02;
  }
  return test::exact_samples(empty, truth, 30);
}

/// The camera against the arm, or the arm against the image, or both.
Problem problem_of(bool hand_eye, bool pixels) {
  Problem problem = test::scene_problem();
  if (hand_eye) problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {.scale = 2.0});
  if (pixels) problem.add_block("pixels", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01});
  for (const Sample& sample : samples()) problem.add_sample(sample);
  return problem;
}

const std::vector<std::string> kShared = {"elbow", "wrist", "camera_joint_x", "camera_joint_a"};

TEST(CeresBridge, ProblemsThatShareParametersAddUp) {
  const Problem both = problem_of(true, true), first = problem_of(true, false),
                second = problem_of(false, true);
  const ParameterTable& table = both.table();
  std::vector<std::string> all = kShared;
  all.emplace_back("camera_fx");
  const FreeSet free = test::free_of(table, all), shared = test::free_of(table, kShared);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(table.size());
  values(table.index("elbow")) = 0.01;

  ceres::Problem ceres_problem;
  CeresBridge bridge(ceres_problem);
  bridge.add(first, free, values);
  bridge.add(second, shared, Eigen::VectorXd::Zero(table.size()));  // starts where the first does
  EXPECT_EQ(ceres_problem.NumParameterBlocks(), 4);
  EXPECT_EQ(ceres_problem.NumResidualBlocks(), 2);
  EXPECT_THAT(bridge.parameters("camera_joint"), ElementsAre("camera_joint_x", "camera_joint_a"));
  EXPECT_THAT(bridge.parameters("camera"), ElementsAre("camera_fx"));
  EXPECT_EQ(bridge.block("elbow")[0], 0.01);

  const NormalEquations expected =
      normal_equations(both, {values.data(), static_cast<std::size_t>(values.size())}, &free);
  ceres::Problem::EvaluateOptions order;
  for (const char* name : {"elbow", "wrist", "camera_joint", "camera"}) {
    order.parameter_blocks.push_back(bridge.block(name));
  }
  double cost = 0.0;
  std::vector<double> gradient;
  ASSERT_TRUE(ceres_problem.Evaluate(order, &cost, nullptr, &gradient, nullptr));
  EXPECT_NEAR(cost, expected.cost, kSums * expected.cost);
  ASSERT_EQ(gradient.size(), 5u);
  for (int c = 0; c < 5; ++c) {
    EXPECT_NEAR(gradient[static_cast<std::size_t>(c)], expected.gradient(c),
                kSums * expected.gradient.norm());
  }
}

struct Pull {
  template <class S>
  bool operator()(const S* elbow, S* residual) const {
    residual[0] = 1e3 * (elbow[0] - 0.5);
    return true;
  }
};

TEST(CeresBridge, SolvesAsSolveDoesAndWithResidualsOfOnesOwn) {
  const Problem problem = problem_of(true, false);
  const ParameterTable& table = problem.table();
  const FreeSet free = test::free_of(table, kShared);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(table.size()), found = expected;
  expected(table.index("camera_fx")) = found(table.index("camera_fx")) = 0.02;  // held
  const Eigen::VectorXd start = found;
  ASSERT_TRUE(solve(problem, free, expected).converged);

  ceres::Problem ceres_problem;
  CeresBridge bridge(ceres_problem);
  bridge.add(problem, free, start);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-16;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  bridge.read(table, found);
  EXPECT_LE((found - expected).norm(), 1e-8);
  EXPECT_NEAR(found(table.index("elbow")), 0.02, 1e-8);

  ceres_problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Pull, 1, 1>(new Pull), nullptr,
                                 bridge.block("elbow"));
  ceres::Solve(options, &ceres_problem, &summary);
  EXPECT_GT(bridge.block("elbow")[0], 0.3);
}

TEST(CeresBridge, HasTheBoundsOfTheTable) {
  ParameterTable table = test::scene_table();
  table["elbow"].upper = 0.01;
  Problem problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  for (const Sample& sample : samples()) problem.add_sample(sample);
  ceres::Problem ceres_problem;
  CeresBridge bridge(ceres_problem);
  bridge.add(problem, test::free_of(table, {"elbow"}), table.values());
  EXPECT_EQ(ceres_problem.GetParameterUpperBound(bridge.block("elbow"), 0), 0.01);
}

TEST(CeresBridge, RefusesABlockOfOtherParametersAndNamesTheNearestBlock) {
  const Problem problem = problem_of(true, false);
  const ParameterTable& table = problem.table();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(table.size());
  ceres::Problem ceres_problem;
  CeresBridge bridge(ceres_problem);
  bridge.add(problem, test::free_of(table, {"elbow", "camera_joint_x"}), zero);
  EXPECT_THROW(bridge.add(problem, test::free_of(table, {"wrist", "camera_joint_y"}), zero),
               std::invalid_argument);
  EXPECT_EQ(ceres_problem.NumResidualBlocks(), 1);
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] { (void)bridge.block("elbw"); }),
            "no parameter block 'elbw'; did you mean 'elbow'?");
}

}  // namespace
}  // namespace kinecal
