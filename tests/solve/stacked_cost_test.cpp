#include "kinecal/solve/stacked_cost.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "kinecal/solve/compressed_cost.hpp"
#include "kinecal/solve/solve.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

// Sums over some hundred rows in another order, and H solved in place of J: its condition, squared,
// is 1e4 to 1e5 in scaled columns where parameters can be separated.
constexpr double kSameProblem = 1e-10;

/// A solve to compare in both forms.
struct Trial {
  std::string name;
  Loss loss = {};
  bool priors = false;
  double upper = std::numeric_limits<double>::infinity();  ///< of camera_joint_x and elbow
};

const std::vector<Trial> kTrials = {
    {"no loss"},
    {"huber", {LossType::huber, 0.01}},
    {"cauchy", {LossType::cauchy, 0.01}},
    {"tukey", {LossType::tukey, 0.3}},
    {"priors", {}, true},
    {"bounds", {}, false, 1e-3},
    {"all", {LossType::cauchy, 0.01}, true, 1e-3},
};

const std::vector<std::string> kFree = {
    "shoulder_lift",  "elbow",          "wrist",          "head_tilt",       "camera_joint_x",
    "camera_joint_y", "camera_joint_z", "camera_joint_a", "camera_joint_c",  "camera_fx",
    "camera_fy",      "camera_cx",      "camera_cy",      "camera_z_offset", "camera_z_scaling"};

/// Camera against arm and arm against image, with noise, some features that are no numbers and
/// samples of several shapes.
Problem problem_of(const Trial& trial) {
  ParameterTable table = test::scene_table();
  table["camera_joint_x"].upper = trial.upper;
  table["elbow"].upper = trial.upper;
  Problem problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"},
                    {.scale = 2.0, .loss = trial.loss});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"},
                    {.scale = 0.002, .loss = trial.loss});
  if (trial.priors) {
    problem.add_prior("restrict", {"camera_joint", 0.0, 2.0, 3.0}, {.scale = 0.1});
    problem.add_prior("elbow", {"elbow", 1.0, 0.0, 0.0}, {.loss = {LossType::huber, 0.001}});
  }
  std::vector<double> truth = test::random_values(table, 0.03, 11);
  for (int i = 0; i < table.size(); ++i) {
    if (std::find(kFree.begin(), kFree.end(), table[i].name) == kFree.end()) {
      truth[static_cast<std::size_t>(i)] = 0.0;
    }
  }
  truth[static_cast<std::size_t>(table.index("camera_joint_x"))] = 0.01;  // beyond the bounds
  truth[static_cast<std::size_t>(table.index("elbow"))] = 0.03;
  std::vector<Sample> samples = test::exact_samples(problem, truth, 30);
  std::mt19937 random(21);
  std::normal_distribution<double> normal(0.0, 1e-3);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    auto& seen = samples[n].observations;
    for (Feature& feature : seen[1].features) {
      feature.point += Vector3<double>{normal(random), normal(random), normal(random)};
    }
    if (n % 7 == 2) seen[1].features[n % 4].point.z() = std::nan("");
    if (n % 5 == 3) seen.pop_back();
    problem.add_sample(samples[n]);
  }
  return problem;
}

struct Solved {
  Eigen::VectorXd values;
  StepResult result;
};

Solved solved(const Problem& problem, CostForm form, int iterations) {
  Solved s;
  s.values = Eigen::VectorXd::Zero(problem.table().size());
  SolveOptions options;
  options.form = form;
  options.max_num_iterations = iterations;
  s.result = solve(problem, test::free_of(problem.table(), kFree), s.values, options);
  return s;
}

std::span<const double> numbers_of(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// How much a change of the free parameters changes the weighted residuals, to first order.
double change_of_residuals(const NormalEquations& at_start, const FreeSet& free,
                           const Eigen::VectorXd& change) {
  Eigen::VectorXd dx(free.size());
  for (int c = 0; c < free.size(); ++c) {
    dx(c) = change(free.parameters()[static_cast<std::size_t>(c)]);
  }
  return std::sqrt(dx.dot(at_start.hessian * dx));
}

TEST(StackedResiduals, HaveTheCostAndGradientOfTheNormalEquations) {
  for (const Trial& trial : kTrials) {
    for (const Losses losses : {Losses::as_given, Losses::convex}) {
      SCOPED_TRACE(trial.name);
      const Problem problem = problem_of(trial);
      const FreeSet free = test::free_of(problem.table(), kFree);
      Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
      values(problem.table().index("board_x")) = 0.5;  // held
      std::vector<double> x(static_cast<std::size_t>(free.size()), 0.0);
      StackedResiduals stack(problem, free, values, x.data(), losses);
      ceres::Problem::Options options;
      options.evaluation_callback = &stack;
      ceres::Problem ceres_problem(options);
      stack.add_to(ceres_problem, x.data());
      for (const double at : {0.0, 5e-4, -3e-3}) {  // also where values have changed since
        for (double& value : x) value = at;
        for (const int p : free.parameters()) values(p) = at;
        double cost = 0.0;
        std::vector<double> gradient;
        ASSERT_TRUE(ceres_problem.Evaluate({}, &cost, nullptr, &gradient, nullptr));
        const NormalEquations expected =
            normal_equations(problem, numbers_of(values), &free, losses);
        NormalEquations found = expected;  // Ceres has no Hessian
        found.cost = cost;
        found.gradient = Eigen::Map<Eigen::VectorXd>(gradient.data(), free.size());
        test::expect_same(found, expected, kSameProblem);
      }
    }
  }
}

TEST(StackedResiduals, AreOneBlockForEachFeatureAndPrior) {
  const Problem problem = problem_of({"priors", {}, true});
  const FreeSet free = test::free_of(problem.table(), kFree);
  std::vector<double> x(static_cast<std::size_t>(free.size()), 0.0);
  StackedResiduals stack(problem, free, Eigen::VectorXd::Zero(problem.table().size()), x.data(),
                         Losses::as_given);
  ceres::Problem::Options options;
  options.evaluation_callback = &stack;
  ceres::Problem ceres_problem(options);
  stack.add_to(ceres_problem, x.data());
  // 30 samples of 4 features; n % 7 == 2: 4 lose one of the camera; n % 5 == 3: 6 have no eye.
  EXPECT_EQ(ceres_problem.NumResidualBlocks(), (30 * 4 - 4) + (30 - 6) * 4 + 2);
  EXPECT_EQ(ceres_problem.NumResiduals(), problem.num_residuals());
}

TEST(StackedResiduals, TakeTheSameFirstStepAsTheCompressedCost) {
  for (const Trial& trial : kTrials) {
    SCOPED_TRACE(trial.name);
    const Problem problem = problem_of(trial);
    const Solved stacked = solved(problem, CostForm::stacked, 1);
    const Solved compressed = solved(problem, CostForm::compressed, 1);
    EXPECT_EQ(stacked.result.form, CostForm::stacked);
    EXPECT_EQ(compressed.result.form, CostForm::compressed);
    EXPECT_EQ(stacked.result.iterations, compressed.result.iterations);
    EXPECT_NEAR(stacked.result.initial_cost, compressed.result.initial_cost,
                kSameProblem * compressed.result.initial_cost);
    EXPECT_NEAR(stacked.result.final_cost, compressed.result.final_cost,
                kSameProblem * compressed.result.initial_cost);
    const FreeSet free = test::free_of(problem.table(), kFree);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem.table().size());
    const NormalEquations start = normal_equations(problem, numbers_of(zero), &free);
    const double step = change_of_residuals(start, free, compressed.values);
    EXPECT_GT(step, 0.1 * std::sqrt(2.0 * start.cost)) << "no step was taken";
    EXPECT_LE(change_of_residuals(start, free, stacked.values - compressed.values),
              kSameProblem * step);
  }
}

TEST(StackedResiduals, EndAtTheSameCostAsTheCompressedCost) {
  for (const Trial& trial : kTrials) {
    SCOPED_TRACE(trial.name);
    const Problem problem = problem_of(trial);
    const Solved stacked = solved(problem, CostForm::stacked, 1000);
    const Solved compressed = solved(problem, CostForm::compressed, 1000);
    EXPECT_TRUE(stacked.result.converged) << stacked.result.termination;
    EXPECT_TRUE(compressed.result.converged) << compressed.result.termination;
    EXPECT_EQ(stacked.result.form, CostForm::stacked);
    EXPECT_LT(compressed.result.final_cost, 0.5 * compressed.result.initial_cost);
    EXPECT_NEAR(stacked.result.final_cost, compressed.result.final_cost,
                kSameProblem * compressed.result.final_cost);
    if (std::isfinite(trial.upper)) {
      for (const Solved& s : {stacked, compressed}) {
        EXPECT_LE(s.values(problem.table().index("camera_joint_x")), trial.upper);
        EXPECT_LE(s.values(problem.table().index("elbow")), trial.upper);
      }
    }
  }
}

/// A point behind the camera during a solve makes Ceres take a shorter step, in either form.
TEST(StackedResiduals, RefuseValuesForWhichAResidualIsNotDefined) {
  const Problem problem = problem_of({"no loss"});
  const FreeSet free = test::free_of(problem.table(), {"head_pan"});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem.table().size());
  std::vector<double> x = {0.0};
  StackedResiduals stack(problem, free, zero, x.data(), Losses::as_given);
  ceres::Problem::Options options;
  options.evaluation_callback = &stack;
  ceres::Problem ceres_problem(options);
  stack.add_to(ceres_problem, x.data());
  Evaluator<Packet> evaluator(problem, free);
  const detail::CompressedCost compressed(evaluator, zero);
  Eigen::Vector2d r;
  for (const double pan : {0.0, M_PI, 0.01}) {
    x[0] = pan;
    const bool defined = pan < 1.0;
    const double* blocks[] = {x.data()};
    double cost = 0.0;
    EXPECT_EQ(ceres_problem.Evaluate({}, &cost, nullptr, nullptr, nullptr), defined) << pan;
    EXPECT_EQ(compressed.Evaluate(blocks, r.data(), nullptr), defined) << pan;
    if (defined) {
      EXPECT_NEAR(cost, 0.5 * r.squaredNorm(), kSameProblem * cost);
    }
  }
}

}  // namespace
}  // namespace kinecal
