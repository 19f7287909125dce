// Error blocks that look at no sensor: joints, conditions and the sample before.  Wheels are the model: what they turned
// against the way that was tracked.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "kinecal/errors.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/solve/solve.hpp"
#include "kinecal/testing.hpp"
#include "support/check_rows.hpp"
#include "support/thrown.hpp"
#include "support/wheels.hpp"

namespace kinecal {
namespace {

using test::Wheels;

static_assert(ErrorBlock<Wheels> && kSensors<Wheels> == 0 && kResiduals<Wheels> == 2);

/// A residual of parameters alone is a prior, and one of conditions alone has nothing to find.
struct Nothing {
  static constexpr std::array<std::string_view, 1> kConditions = {"way"};
  template <class Q>
  [[nodiscard]] Eigen::Matrix<Q, 1, 1> operator()(const std::array<Q, 1>& c) const {
    return Eigen::Matrix<Q, 1, 1>(c[0]);
  }
};
static_assert(!ErrorBlock<Nothing>);

constexpr std::array kTruth = {0.102, 0.0985, 0.53};

/// A drive of so many samples, in which the scene's arm is seen, too.
template <class S>
std::vector<Sample> drive(const BasicProblem<S>& problem, int count) {
  std::vector<Sample> samples =
      test::open_samples(problem, test::values_at("zero", problem.table()), count);
  double left = 3.0, right = -2.0;
  for (Sample& sample : samples) {
    const auto n = static_cast<double>(&sample - samples.data());
    const double by_left = std::sin(n), by_right = 1.0 + 0.3 * std::cos(2.0 * n);
    left += by_left;
    right += by_right;
    const double way_left = kTruth[0] * by_left, way_right = kTruth[1] * by_right;
    sample.conditions = {{"way", 0.5 * (way_left + way_right)},
                         {"turn", (way_right - way_left) / kTruth[2]}};
    for (const auto& [name, position] : {std::pair("wheel_left", left), {"wheel_right", right}}) {
      sample.joint_names.emplace_back(name);
      sample.joint_positions.push_back(position);
    }
  }
  set_before(samples);
  return samples;
}

template <class S>
BasicProblem<S> wheels_problem(const TermOptions& options = {}) {
  return test::open_problem<S>(Wheels{}, {}, options);
}

template <class S>
class WithoutSensor : public testing::Test {};
using Scalars = testing::Types<double, Packet>;
TYPED_TEST_SUITE(WithoutSensor, Scalars);

TYPED_TEST(WithoutSensor, WheelsAreFound) {
  BasicProblem<TypeParam> problem = wheels_problem<TypeParam>();
  for (const Sample& sample : drive(problem, 11)) problem.add_sample(sample);
  EXPECT_EQ(problem.samples_of(0), 10) << "the first has none before it";
  EXPECT_EQ(problem.num_residuals(), 20);
  EXPECT_FALSE(problem.is_used(0));
  Eigen::VectorXd values = problem.table().values();
  const auto free = test::free_of(problem.table(), {"block_left", "block_right", "block_track"});
  ASSERT_TRUE(solve(problem, free, values).converged);
  for (std::size_t i = 0; i < kTruth.size(); ++i) {
    EXPECT_NEAR(values(free.parameters()[i]), kTruth[i], 1e-12);
  }
}

TYPED_TEST(WithoutSensor, RowsAndSumsAreThoseOfCentralDifferences) {
  BasicProblem<TypeParam> problem =
      wheels_problem<TypeParam>({.scale = 3.0, .sigma = 0.5, .loss = {LossType::cauchy, 0.5}});
  for (const Sample& sample : drive(problem, 11)) problem.add_sample(sample);
  const std::vector<double> x = test::values_at("random", problem.table());
  test::check_central_differences(problem, x);
  const FreeSet all = test::all_free(problem.table());
  NormalEquations expected(all.size());
  for (const auto& [key, rows] : test::rows_of(problem, x, &all)) {
    const double w2 = 36.0, squared = w2 * rows.residual.squaredNorm();  // (3 / 0.5)^2
    const auto loss = Loss{LossType::cauchy, 0.5}(squared);
    expected.cost += 0.5 * loss.rho;
    expected.gradient += w2 * loss.derivative * rows.jacobian.transpose() * rows.residual;
    expected.hessian += w2 * loss.derivative * rows.jacobian.transpose() * rows.jacobian;
  }
  EXPECT_GT(expected.cost, 0.0);
  test::expect_same(normal_equations(problem, x, &all), expected, 1e-12);
}

/// A base against the tracked pose of a sensor on it, or against a wall.
template <class S, class B>
void check_base(const B& block) {
  BasicProblem<S> problem = test::open_problem<S>(block, {}, {.scale = 2.0});
  std::vector<Sample> samples =
      test::open_samples(problem, test::values_at("zero", problem.table()), 7);
  for (Sample& sample : samples) {
    double n = static_cast<double>(&sample - samples.data());
    for (const std::string_view name : kConditionsOfBlock<B>) {
      if (!name.starts_with(kBefore)) sample.conditions[std::string(name)] = std::sin(n += 0.7);
    }
  }
  set_before(samples);
  for (const Sample& sample : samples) problem.add_sample(sample);
  EXPECT_EQ(problem.samples_of(0), 6);
  std::vector<double> x = test::values_at("random", problem.table());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += problem.table()[static_cast<int>(i)].initial;  // of scales: 1
  }
  test::check_central_differences(problem, x);
}

TYPED_TEST(WithoutSensor, RowsOfABaseAreThoseOfCentralDifferences) {
  check_base<TypeParam>(DifferentialToPose{});
  check_base<TypeParam>(TricycleToWall{});
  check_base<TypeParam>(OdometryToWall{});
  check_base<TypeParam>(GyroToPose{});
}

TEST(WithoutSensors, ANumberThatIsMissingSkipsTheSample) {
  Problem problem = wheels_problem<Packet>();
  std::vector<Sample> samples = drive(problem, 5);
  samples[3].conditions["turn"] = std::numeric_limits<double>::quiet_NaN();
  for (const Sample& sample : samples) problem.add_sample(sample);
  EXPECT_EQ(problem.samples_of(0), 3);
}

TEST(WithoutSensors, KeepTheLaws) {
  EXPECT_EQ(check_block(Wheels{}), kLawsHold);
}

TEST(WithoutSensors, LeaveSamplesToOtherBlocks) {
  Problem both = wheels_problem<Packet>(), alone = wheels_problem<Packet>();
  both.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  std::vector<Sample> samples = drive(both, 9);
  for (Sample& sample : samples) {
    both.add_sample(sample);
    alone.add_sample(sample);
  }
  const std::vector<double> x = test::values_at("random", both.table());
  const FreeSet all = test::all_free(both.table());
  const test::OracleRows of_both = test::rows_of(both, x, &all);
  for (const auto& [key, rows] : test::rows_of(alone, x, &all)) {
    ASSERT_TRUE(of_both.contains(key));
    EXPECT_EQ(of_both.at(key).jacobian, rows.jacobian);
  }
  both.exclude({3});  // what was recorded before sample 4 stays
  EXPECT_EQ(both.samples_of(0), 7);
  samples[5].conditions.clear();  // nothing was tracked
  Problem gap = wheels_problem<Packet>();
  for (const Sample& sample : samples) gap.add_sample(sample);
  EXPECT_EQ(gap.samples_of(0), 7) << "sample 5 has the joints only";
}

TEST(WithoutSensors, NameWhatIsMissing) {
  Problem problem = wheels_problem<Packet>();
  std::vector<Sample> samples = drive(problem, 3);
  Sample& sample = samples[2];
  sample.source = "drive.csv:4";
  sample.conditions.erase("turn");
  sample.conditions["turns"] = 0.1;
  EXPECT_EQ(test::thrown<SampleError>([&] { problem.add_sample(sample); }, "no error"),
            "drive.csv:4: error block 'block': condition 'turn' is not in the sample; did you mean "
            "'turns'?");
  sample.conditions["turn"] = 0.1;
  sample.before.erase("wheel_left");
  EXPECT_THAT(test::thrown<SampleError>([&] { problem.add_sample(sample); }, "no error"),
              testing::HasSubstr("condition 'before wheel_left' is not in the sample"));
  EXPECT_EQ(problem.num_samples(), 0);
}

}  // namespace
}  // namespace kinecal
