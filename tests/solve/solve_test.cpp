#include "kinecal/solve/solve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/solve/solve_with.ipp"
#include "support/fisheye.hpp"
#include "support/scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

/// Parameters of the scene that camera and arm together determine.
const std::vector<std::string> kObservable = {
    "shoulder_lift",  "elbow",          "wrist",          "head_tilt",       "camera_joint_x",
    "camera_joint_y", "camera_joint_z", "camera_joint_a", "camera_joint_c",  "camera_fx",
    "camera_fy",      "camera_cx",      "camera_cy",      "camera_z_offset", "camera_z_scaling"};

FreeSet free_of(const ParameterTable& table, const std::vector<std::string>& names) {
  std::vector<int> indices;
  for (const std::string& name : names) indices.push_back(table.index(name));
  return FreeSet(indices, table.size());
}

/// True values: some error in every observable parameter.
Eigen::VectorXd true_values(const ParameterTable& table) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(table.size());
  const std::vector<double> random = test::random_values(table, 0.03, 11);
  for (const std::string& name : kObservable) {
    values(table.index(name)) = random[static_cast<std::size_t>(table.index(name))];
  }
  return values;
}

std::span<const double> span_of(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// Samples of the true robot with noise on the camera's points.
/// @param noise  standard deviation, metres
std::vector<Sample> noisy_samples(int count, double noise) {
  const Problem problem = test::scene_problem();
  std::vector<Sample> samples =
      test::exact_samples(problem, span_of(true_values(problem.table())), count);
  std::mt19937 random(21);
  std::normal_distribution<double> normal(0.0, noise);
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) {
      feature.point += Vector3<double>{normal(random), normal(random), normal(random)};
    }
  }
  return samples;
}

/// Solves camera against arm from zero; the values that were found.
Eigen::VectorXd solved(const std::vector<Sample>& samples, const Loss& loss,
                       StepResult* result = nullptr) {
  Problem problem = test::scene_problem();
  TermOptions options;
  options.loss = loss;
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, options);
  for (const Sample& sample : samples) problem.add_sample(sample);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  const StepResult step = solve(problem, free_of(problem.table(), kObservable), values);
  if (result != nullptr) *result = step;
  return values;
}

TEST(Solve, RecoversInjectedErrorsFromExactSamples) {
  StepResult result;
  const Eigen::VectorXd values = solved(noisy_samples(30, 0.0), {}, &result);
  EXPECT_TRUE(result.converged) << result.termination;
  const Eigen::VectorXd truth = true_values(test::scene_table());
  EXPECT_LE((values - truth).norm(), 1e-8 * truth.norm());
  EXPECT_LE(result.final_cost, 1e-20);
}

TEST(Solve, GivesTheSameBytesForTheSameInput) {
  const auto samples = noisy_samples(20, 1e-3);
  const Eigen::VectorXd first = solved(samples, {}), second = solved(samples, {});
  EXPECT_TRUE(first == second);
}

TEST(Solve, OneBadCaptureAmongAHundredMovesTheParametersTenTimesLessWithALoss) {
  const std::vector<Sample> clean = noisy_samples(100, 1e-3);
  for (const LossType type : {LossType::huber, LossType::cauchy, LossType::tukey}) {
    // About one and six standard deviations of the noise.
    const Loss loss{type, type == LossType::tukey ? 0.006 : 0.001};
    for (const std::size_t bad : {7u, 50u, 93u}) {
      std::vector<Sample> spoiled = clean;
      for (Feature& f : spoiled[bad].observations[1].features) f.point.x() += 0.05;
      const double without = (solved(spoiled, {}) - solved(clean, {})).norm();
      const double with = (solved(spoiled, loss) - solved(clean, loss)).norm();
      EXPECT_LT(with, 0.1 * without) << static_cast<int>(type) << ", sample " << bad;
    }
  }
}

TEST(Solve, ALossThatSeesNothingFromFarAwayIsStartedFromAConvexOne) {
  StepResult result;
  const Eigen::VectorXd values = solved(noisy_samples(30, 1e-4), {LossType::tukey, 0.002}, &result);
  EXPECT_TRUE(result.converged) << result.termination;
  const Eigen::VectorXd truth = true_values(test::scene_table());
  EXPECT_LE((values - truth).norm(), 0.1 * truth.norm());
}

TEST(Solve, RefusesAPlateauOnWhichTheLossLeavesOutHalfOfTheFeatures) {
  StepResult result;
  const Eigen::VectorXd values = solved(noisy_samples(30, 5e-3), {LossType::tukey, 1e-4}, &result);
  EXPECT_FALSE(result.converged);
  EXPECT_NE(result.termination.find("'hand_eye' leaves out half"), std::string::npos)
      << result.termination;
  EXPECT_TRUE(values.isZero(0.0)) << "unusable results must not change the values";
}

/// The scene with one parameter's bounds, and camera against arm.
Problem bounded_problem(const std::string& name, double lower, double upper,
                        const std::vector<Sample>& samples) {
  ParameterTable table = test::scene_table();
  table[name].lower = lower;
  table[name].upper = upper;
  Problem problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  for (const Sample& sample : samples) problem.add_sample(sample);
  return problem;
}

/// An active bound costs exactly what holding the parameter there costs.
TEST(Solve, AnActiveBoundEndsAtTheMinimumOfTheOtherParameters) {
  const auto samples = noisy_samples(30, 1e-3);
  const Eigen::VectorXd unbounded = solved(samples, {});
  for (const std::string name : {"camera_joint_x", "elbow", "camera_fx"}) {
    const double bound = 0.3 * unbounded(test::scene_table().index(name));
    const Problem problem =
        bounded_problem(name, std::min(0.0, bound), std::max(0.0, bound), samples);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    const StepResult result = solve(problem, free_of(problem.table(), kObservable), values);
    EXPECT_TRUE(result.converged) << result.termination;
    EXPECT_NEAR(values(problem.table().index(name)), bound, 1e-12) << name;

    std::vector<std::string> others = kObservable;
    std::erase(others, name);
    Eigen::VectorXd held = Eigen::VectorXd::Zero(problem.table().size());
    held(problem.table().index(name)) = bound;
    const StepResult reference = solve(problem, free_of(problem.table(), others), held);
    EXPECT_NEAR(result.final_cost / reference.final_cost, 1.0, 1e-9) << name;
  }
}

TEST(Solve, AStartBeyondABoundIsMovedOntoIt) {
  const auto samples = noisy_samples(20, 1e-3);
  const Problem problem = bounded_problem("elbow", -0.05, 0.05, samples);
  const FreeSet free = free_of(problem.table(), kObservable);
  Eigen::VectorXd beyond = Eigen::VectorXd::Zero(problem.table().size()), on_bound = beyond;
  beyond(problem.table().index("elbow")) = 0.4;
  on_bound(problem.table().index("elbow")) = 0.05;
  const StepResult found = solve(problem, free, beyond), expected = solve(problem, free, on_bound);
  EXPECT_TRUE(found.converged) << found.termination;
  EXPECT_EQ(found.initial_cost, expected.initial_cost);
  EXPECT_TRUE(beyond == on_bound);
}

TEST(Solve, ABoundThatIsNotReachedChangesNothing) {
  const auto samples = noisy_samples(20, 1e-3);
  const Problem problem = bounded_problem("elbow", -1.0, 1.0, samples);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  const StepResult result = solve(problem, free_of(problem.table(), kObservable), values);
  StepResult unbounded;
  (void)solved(samples, {}, &unbounded);
  EXPECT_NEAR(result.final_cost / unbounded.final_cost, 1.0, 1e-9);
}

/// Errors of a centimetre are outliers for a block of a tenth of a millimetre, unless they say so.
TEST(Solve, ALossJudgesAFeatureByItsOwnSigma) {
  static constexpr double kSigma = 1e-4;
  std::vector<Sample> samples = noisy_samples(20, 0.01);
  const auto solved_with_tukey = [](const std::vector<Sample>& given) {
    Problem problem = test::scene_problem();
    problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"},
                      {.sigma = kSigma, .loss = {LossType::tukey, 6.0}});
    for (const Sample& sample : given) problem.add_sample(sample);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    return solve(problem, free_of(problem.table(), kObservable), values);
  };
  EXPECT_THAT(solved_with_tukey(samples).termination, testing::HasSubstr("leaves out half"));
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.sigma = 0.01;
  }
  const StepResult result = solved_with_tukey(samples);
  EXPECT_TRUE(result.converged) << result.termination;
}

TEST(Solve, HoldsWhatIsNotFree) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  for (const Sample& sample : noisy_samples(10, 1e-3)) problem.add_sample(sample);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  values(problem.table().index("elbow")) = 0.125;
  (void)solve(problem, free_of(problem.table(), {"wrist", "camera_joint_x"}), values);
  for (int i = 0; i < values.size(); ++i) {
    const std::string& name = problem.table()[i].name;
    if (name == "wrist" || name == "camera_joint_x") {
      EXPECT_NE(values(i), 0.0);
    } else {
      EXPECT_EQ(values(i), name == "elbow" ? 0.125 : 0.0) << name;
    }
  }
}

TEST(Solve, SaysWhereAResidualIsNotDefinedAtTheStart) {
  Problem problem = test::scene_problem();
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {});
  Sample sample = noisy_samples(1, 0.0)[0];
  sample.source = "s.yaml:12";
  problem.add_sample(sample);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  values(problem.table().index("head_pan")) = M_PI;  // looks the other way
  const StepResult result = solve(problem, free_of(problem.table(), {"elbow"}), values);
  EXPECT_FALSE(result.converged);
  EXPECT_NE(result.termination.find("'reprojection'"), std::string::npos) << result.termination;
  EXPECT_NE(result.termination.find("s.yaml:12"), std::string::npos) << result.termination;
}

/// The camera stands a centimetre off.  Each of N samples has four features with |d r / d x| = 1
/// and a prior of scale p:  cost = N / 2 (4 (x - 0.01)^2 + (p x)^2), least at x = 4 / (4 + p^2)
/// 0.01
TEST(Solve, APriorCountsOncePerSampleAndPullsToZero) {
  constexpr double kOff = 0.01, kScale = 3.0;
  constexpr int kSamples = 7;
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  problem.add_prior("restrict", {"camera_joint", 0.0, 2.0, 5.0}, {.scale = kScale / 2.0});
  const int x = problem.table().index("camera_joint_x");
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(problem.table().size());
  truth(x) = kOff;
  for (const Sample& sample : test::exact_samples(problem, span_of(truth), kSamples)) {
    problem.add_sample(sample);
  }
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SCOPED_TRACE(to_string(form));
    SolveOptions options;
    options.form = form;
    Eigen::VectorXd values = truth;
    const StepResult result =
        solve(problem, free_of(problem.table(), {"camera_joint_x"}), values, options);
    EXPECT_TRUE(result.converged) << result.termination;
    constexpr double kRounding = 1e-10, kSquared = kScale * kScale;
    constexpr double kEnds = 1e-8;  // the cost falls by less than 1e-14 of it from there
    EXPECT_NEAR(result.initial_cost, 0.5 * kSamples * kSquared * kOff * kOff,
                kRounding * result.initial_cost);
    EXPECT_NEAR(values(x), 4.0 / (4.0 + kSquared) * kOff, kEnds * kOff);
    EXPECT_NEAR(result.final_cost, 0.5 * kSamples * 4.0 * kSquared / (4.0 + kSquared) * kOff * kOff,
                kRounding * result.initial_cost);
  }
}

/// Of a joint and a frame each axis has its own scale.
TEST(Solve, APriorScalesJointTranslationAndRotation) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  problem.add_prior("restrict", {"head_pan", 4.0, 2.0, 3.0}, {});
  std::vector<double> values = test::random_values(problem.table(), 0.03, 11);
  const auto value = [&](const char* name) {
    return values[static_cast<std::size_t>(problem.table().index(name))];
  };
  for (const Sample& sample : test::exact_samples(problem, values, 7)) problem.add_sample(sample);
  double squares = std::pow(4.0 * value("head_pan"), 2);
  for (const char* axis : {"head_pan_x", "head_pan_y", "head_pan_z"}) {
    squares += std::pow(2.0 * value(axis), 2);
  }
  for (const char* axis : {"head_pan_a", "head_pan_b", "head_pan_c"}) {
    squares += std::pow(3.0 * value(axis), 2);
  }
  EXPECT_NEAR(normal_equations(problem, values, nullptr).cost / (0.5 * 7 * squares), 1.0, 1e-10);
}

/// Two thousand samples: several pieces for the threads to share.
TEST(Solve, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto samples = noisy_samples(100, 1e-3);
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"},
                    {.loss = {LossType::cauchy, 0.002}});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01});
  for (std::size_t n = 0; n < 1500; ++n) problem.add_sample(samples[n % samples.size()]);
  const FreeSet free = free_of(problem.table(), kObservable);
  std::optional<Eigen::VectorXd> one;
  StepResult of_one;
  for (const int threads : {1, 2, 5, 0}) {
    SolveOptions options;
    options.threads = threads;
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    const StepResult result = solve(problem, free, values, options);
    EXPECT_TRUE(result.converged) << result.termination;
    if (!one) {
      one = values;
      of_one = result;
    }
    EXPECT_TRUE(values == *one) << threads << " threads";
    EXPECT_EQ(result.final_cost, of_one.final_cost) << threads << " threads";
    EXPECT_EQ(result.iterations, of_one.iterations) << threads << " threads";
  }
}

/// Counts the evaluations with derivatives of another evaluator.
class CountingEvaluator final : public AnyEvaluator {
 public:
  CountingEvaluator(std::unique_ptr<AnyEvaluator> all, int& count)
      : all_(std::move(all)), count_(count) {}

  [[nodiscard]] const AnyProblem& problem() const override { return all_->problem(); }
  [[nodiscard]] const FreeSet& free() const override { return all_->free(); }
  std::optional<UndefinedResidual> evaluate(ParameterValues values, bool derivatives,
                                            const RowVisitor& visit, Linearization at) override {
    return all_->evaluate(values, derivatives, visit, at);
  }
  [[nodiscard]] NormalEquations normal_equations(ParameterValues values, bool derivatives,
                                                 Losses losses) override {
    count_ += derivatives ? 1 : 0;
    return all_->normal_equations(values, derivatives, losses);
  }

 private:
  std::unique_ptr<AnyEvaluator> all_;
  int& count_;
};

/// What the step before the last and the linear model say of the end holds there.
TEST(Solve, TheLastStepNeedsNoDerivativesAndEndsAtTheMinimum) {
  const std::vector<Sample> samples = noisy_samples(30, 1e-3);
  int without = 0;
  for (const LossType type : {LossType::none, LossType::huber}) {
    Problem problem = test::scene_problem();
    TermOptions term;
    term.loss = {type, 0.002};
    problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, term);
    for (const Sample& sample : samples) problem.add_sample(sample);
    const FreeSet free = free_of(problem.table(), kObservable);
    for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
      SolveOptions options;
      options.function_tolerance = tolerance;
      int derivatives = 0;
      const auto evaluator_of = [&](const FreeSet& columns) -> std::unique_ptr<AnyEvaluator> {
        return std::make_unique<CountingEvaluator>(problem.evaluator(columns, 1), derivatives);
      };
      StepResult counts;
      counts.num_residuals = problem.num_residuals();
      counts.num_parameters = free.size();
      Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
      const StepResult result = detail::solve_with(evaluator_of, free, values, options, counts);
      ASSERT_TRUE(result.converged) << result.termination;
      if (derivatives != result.evaluations - 1) continue;  // it ended otherwise
      ++without;
      constexpr double kRounding = 1e-12;  // of sums, with derivatives and without
      const NormalEquations end = normal_equations(problem, span_of(values), &free);
      EXPECT_EQ(result.final_cost, result.costs.back());
      EXPECT_NEAR(result.final_cost, end.cost, kRounding * end.cost);
      const Eigen::VectorXd promised = detail::EquivalentResidual(end).residual.head(free.size());
      EXPECT_LE(0.5 * promised.squaredNorm(), tolerance * end.cost) << tolerance;
    }
  }
  EXPECT_GT(without, 0);
}

/// Solves with at most so many iterations.
StepResult solved_in(int iterations, const std::vector<Sample>& samples, double weight) {
  Problem problem = test::scene_problem();
  TermOptions options;
  options.scale = weight;
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, options);
  for (const Sample& sample : samples) problem.add_sample(sample);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  SolveOptions solving;
  solving.max_num_iterations = iterations;
  return solve(problem, free_of(problem.table(), kObservable), values, solving);
}

// Units of chi-square: twice the cost over the variance of the residuals, which is known only from
// the residuals if no sigma was given.
TEST(Solve, WithoutIterationsLeftItHasConvergedIfTheNoiseIsLargerThanWhatIsLeft) {
  const std::vector<Sample> samples = noisy_samples(20, 1e-3);
  const StepResult all = solved_in(1000, samples, 1.0);
  ASSERT_TRUE(all.converged) << all.termination;
  const double variance =
      2.0 * all.final_cost / static_cast<double>(all.num_residuals - all.num_parameters);
  int refused = 0, accepted = 0;
  for (int most = 1; most < all.iterations; ++most) {
    const StepResult cut = solved_in(most, samples, 1.0);
    if (cut.termination.find("iterations are used up") == std::string::npos) continue;
    const double left = 2.0 * (cut.final_cost - all.final_cost) / variance;
    if (cut.converged) {
      ++accepted;
      EXPECT_LT(left, 2e-3) << cut.termination;
      EXPECT_TRUE(cut.termination.starts_with("converged")) << cut.termination;
    } else {
      ++refused;
      EXPECT_GT(left, 0.5e-3) << cut.termination;
      EXPECT_TRUE(cut.termination.starts_with("did not converge: ")) << cut.termination;
    }
    EXPECT_EQ(solved_in(most, samples, 1000.0).converged, cut.converged)
        << "a sigma changes nothing";
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(accepted, 0);
}

TEST(Solve, CountsWhatItSolved) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  problem.add_prior("restrict", {"camera_joint", 0.0, 2.0, 3.0}, {});
  for (const Sample& sample : noisy_samples(7, 1e-3)) problem.add_sample(sample);
  const FreeSet free = free_of(problem.table(), kObservable);
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SolveOptions options;
    options.form = form;
    int called = 0;
    double last = 0.0;
    options.progress = [&](int, double cost) {
      ++called;
      last = cost;
    };
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    const StepResult result = solve(problem, free, values, options);
    EXPECT_EQ(result.form, form);
    EXPECT_EQ(result.samples, 7);
    EXPECT_EQ(result.num_parameters, free.size());
    EXPECT_EQ(result.num_residuals, 7 * (4 * 3 + Prior::kRows));
    // The start, too; that of bold steps where nobody knows that a step promises nothing more.
    EXPECT_EQ(called, result.iterations + (form == CostForm::compressed ? 1 : 2));
    EXPECT_GE(result.evaluations, result.iterations);
    if (form == CostForm::compressed) {  // the start, and each step once
      EXPECT_EQ(result.evaluations, result.iterations + 1);
    }
    constexpr double kSums = 1e-9;  // the last iteration's cost, perhaps before a step too small
    EXPECT_NEAR(last, result.final_cost, kSums * last);
  }
}

/// A camera looks along z at two points, one metre ahead: exact pixels, so its z is zero.
Problem camera_ahead() {
  const Robot robot("robot", {{.name = "mount", .parent = "base", .child = "camera"},
                              {.name = "turn",
                               .type = JointType::revolute,
                               .parent = "base",
                               .child = "arm",
                               .axis = {0, 0, 1}}});
  ParameterTable table;
  for (const auto axis : kFrameAxes) table.add({.name = parameter_name("mount", axis)});
  Problem problem(robot, "base", table, {"mount"});
  problem.add_sensor(ChainPoint{}, {"arm", "arm"});
  problem.add_sensor(PinholeCamera{}, {"camera", "camera"});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "camera"});
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.p = {500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0};
  problem.add_sample({{"turn"},
                      {0},
                      {{"arm", {{"arm", {0.1, 0, 1}}, {"arm", {0, 0.1, 1}}}},
                       {"camera", {{"camera", {370, 240, 0}}, {"camera", {320, 290, 0}}}, info}},
                      "here:1"});
  return problem;
}

/// A first step from far behind goes beyond the points.
TEST(Solve, AStepThatPutsAPointBehindTheCameraIsRefusedAndNotTakenForTheMinimum) {
  const Problem problem = camera_ahead();
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    for (const double z : {0.0, -1.0, -2.0}) {
      SCOPED_TRACE(std::string(to_string(form)) + " from " + std::to_string(z));
      SolveOptions options;
      options.form = form;
      double highest = 0.0;
      options.progress = [&](int, double cost) { highest = std::max(highest, cost); };
      Eigen::VectorXd values = Eigen::VectorXd::Zero(6);
      values(2) = z;
      const StepResult result = solve(problem, FreeSet({2}, 6), values, options);
      EXPECT_TRUE(result.converged) << result.termination;
      EXPECT_NEAR(values(2), 0.0, 1e-9);
      // A refused step costs what the values cost where it began.
      EXPECT_DOUBLE_EQ(highest, result.initial_cost);
      for (const double cost : result.costs) EXPECT_LE(cost, highest);
    }
  }
}

/// The derivatives have the wrong sign: every step raises the cost.
struct WrongWay {
  static constexpr const char* kUnit = "m";
  static constexpr const char* kType = "wrong_way";
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p) const {
    const auto falls = [](const S& x) { return S(x - S(2.0 * value_of(x)) + 3.0); };
    return {falls(p.x()), falls(p.y()), falls(p.z())};
  }
};

TEST(Solve, WithoutAStepThatLowersTheCostItHasNotConverged) {
  Problem problem = test::scene_problem();
  problem.add_block("wrong", WrongWay{}, {"camera"});
  for (const Sample& sample : noisy_samples(5, 1e-3)) problem.add_sample(sample);
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SCOPED_TRACE(to_string(form));
    SolveOptions options;
    options.form = form;
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    const StepResult result =
        solve(problem, free_of(problem.table(), {"camera_joint_x"}), values, options);
    EXPECT_FALSE(result.converged);
    EXPECT_THAT(result.termination,
                testing::StartsWith(
                    "did not converge: no step lowered the cost any further, though chi-square "
                    "could still fall by about "));
    EXPECT_DOUBLE_EQ(result.final_cost, result.initial_cost);
    EXPECT_TRUE(values.isZero(0.0));
  }
}

/// What rounding leaves is no reason to doubt it.
TEST(Solve, AStartAtTheMinimumOfExactSamplesHasConverged) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  const Eigen::VectorXd truth = true_values(problem.table());
  for (const Sample& sample : test::exact_samples(problem, span_of(truth), 10)) {
    problem.add_sample(sample);
  }
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SolveOptions options;
    options.form = form;
    Eigen::VectorXd values = truth;
    const StepResult result =
        solve(problem, free_of(problem.table(), kObservable), values, options);
    EXPECT_TRUE(result.converged) << to_string(form) << ": " << result.termination;
  }
}

TEST(Solve, RefusesAStartWhoseCostOverflows) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"},
                    {.loss = {LossType::tukey, 1.0}});
  auto samples = noisy_samples(4, 1e-3);
  samples[2].observations[0].features[1].point.x() = 1e200;
  for (const Sample& sample : samples) problem.add_sample(sample);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
  const StepResult result = solve(problem, free_of(problem.table(), {"elbow"}), values);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.termination, "failed: the cost at the start is not finite");
}

TEST(Solve, NamesAResidualWithoutADerivative) {
  const Robot robot("r", {{"mount", JointType::fixed, "base", "camera"},
                          {"turn", JointType::revolute, "base", "arm", {}, {0, 0, 1}}});
  ParameterTable table;
  table.add({.name = "turn"});
  Problem problem(robot, "base", table, {});
  problem.add_sensor(ChainPoint{}, {"arm", "arm"});
  problem.add_sensor(test::KinkedFisheye{}, {"camera", "camera"});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "camera"});
  problem.add_sample({{"turn"},
                      {0.0},
                      {{"arm", {{"arm", {0, 0, 1}}}}, {"camera", {{"camera", {641, 480, 0}}}}},
                      "a.yaml:7"});
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SolveOptions options;
    options.form = form;
    Eigen::VectorXd values = Eigen::VectorXd::Zero(1);
    testing::internal::CaptureStderr();
    const StepResult result = solve(problem, FreeSet({0}, 1), values, options);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "Ceres logs what it cannot evaluate";
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.termination,
              "failed: a derivative of the residual of 'reprojection' is not defined at the start "
              "for the sample at a.yaml:7");
  }
}

/// Of frames in a row only the sum is determined: with hardly any damping, rounding decides.
TEST(Solve, PrintsNothingWhereManyDirectionsAreUndetermined) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  for (const Sample& sample : noisy_samples(20, 1e-3)) problem.add_sample(sample);
  std::vector<int> all(static_cast<std::size_t>(problem.table().size()));
  std::iota(all.begin(), all.end(), 0);
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SolveOptions options;
    options.form = form;
    options.max_num_iterations = 60;
    options.function_tolerance = 0.0;
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    testing::internal::CaptureStderr();
    (void)solve(problem, FreeSet(all, problem.table().size()), values, options);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << to_string(form);
  }
}

TEST(MakeCalibration, NamesASensorThatIsObservedByNearlyThisName) {
  auto problem = std::make_unique<Problem>(test::scene_problem());
  problem->add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  std::vector<Sample> samples = noisy_samples(2, 1e-3);
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor == "camera") seen.sensor = "camra";
    }
  }
  const FreeSet free = free_of(problem->table(), {"elbow"});
  EXPECT_EQ(test::thrown<std::invalid_argument>(
                [&] { (void)make_calibration(std::move(problem), free, samples); }),
            "no sample has an observation of sensor 'camera'; did you mean 'camra'?");
}

TEST(Solve, RefusesAProblemWithoutSamples) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  for (const CostForm form : {CostForm::compressed, CostForm::stacked}) {
    SolveOptions options;
    options.form = form;
    Eigen::VectorXd values = Eigen::VectorXd::Zero(problem.table().size());
    const StepResult result = solve(problem, free_of(problem.table(), {"elbow"}), values, options);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.termination, "failed: 0 residuals cannot determine 1 parameter");
  }
}

}  // namespace
}  // namespace kinecal
