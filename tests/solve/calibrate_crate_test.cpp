#include "kinecal/solve/calibrate_crate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "kinecal/errors.hpp"
#include "support/oracle.hpp"
#include "support/static_robot.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using test::StaticRobot;
template <FixedString Tip>
using FromBase = Chain<StaticRobot, "base", Tip>;
using Pan = JointOffset<"pan">;
using Elbow = JointOffset<"elbow">;
using ElbowMount = FrameOffset<"mount", Axes::xyz>;

/// A tracker fixed to the base sees points of the tip.
using Tracked = Crate<Chain3d<"arm", FromBase<"tip">>, Chain3d<"tracker", FromBase<"base">>, Pan,
                      Elbow, ElbowMount, Block<"tracking", PointToPoint, "arm", "tracker">>;
/// The same and what no sample of this file says anything of.
using WithCamera =
    Crate<Tracked, Camera3d<"camera", FromBase<"camera_frame">>, DepthCorrection<"camera">,
          Block<"hand_eye", PointToPoint, "camera", "arm">>;

/// Samples of a robot with these values, in the order of the crate's slots.
std::vector<Sample> exact_samples(const std::vector<double>& truth, int count) {
  const ParameterTable table = Tracked().table({});
  Eigen::VectorXd values = Eigen::VectorXd::Zero(table.size());
  const FreeSet free = Tracked::free(table);
  for (int c = 0; c < free.size(); ++c) {
    values(free.parameters()[static_cast<std::size_t>(c)]) = truth[static_cast<std::size_t>(c)];
  }
  const test::OracleValues<double> of_robot(table, values);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-1.0, 1.0);
  std::vector<Sample> samples;
  for (int n = 0; n < count; ++n) {
    Sample& sample = samples.emplace_back();
    sample.source = "sample " + std::to_string(n);
    for (const char* joint : {"lift", "pan", "elbow", "wrist"}) {
      sample.joint_names.emplace_back(joint);
      sample.joint_positions.push_back(angle(random));
    }
    const test::OraclePose<double> tip =
        test::oracle_pose(robot_from<StaticRobot>(), "base", "tip", "", sample, of_robot);
    sample.observations = {{"arm", {}, {}}, {"tracker", {}, {}}};
    for (int i = 0; i < 3; ++i) {
      const Vector3<double> p(0.1 * i, 0.05, 0.02 * i * i);
      sample.observations[0].features.push_back({"tip", p});
      sample.observations[1].features.push_back({"base", tip(p)});
    }
  }
  return samples;
}

TEST(CalibrateCrate, FindsWhatWasPutIn) {
  const std::vector<double> truth = {0.02, -0.03, 0.004, -0.005, 0.006};
  const CrateResult<Tracked> result = calibrate(Tracked(), exact_samples(truth, 12));
  ASSERT_TRUE(result.converged) << result.termination;
  EXPECT_LT(result.steps[0].final_cost, 1e-20);
  EXPECT_NEAR(result.value<Pan>(), truth[0], 1e-10);
  EXPECT_NEAR(result.value<Elbow>(), truth[1], 1e-10);
  const Vector3<double> mount = result.value<ElbowMount>();
  EXPECT_LE((mount - Vector3<double>(truth[2], truth[3], truth[4])).norm(), 1e-10);
}

TEST(CalibrateCrate, SearchesForTheFrameOfATrackerWhereTheStartFails) {
  using OnAStand = Crate<Tracked, VirtualFrame<"stand">>;
  const std::vector<double> truth = {0.02, -0.03, 0.004, -0.005, 0.006};
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 20; ++run) {
    std::vector<Sample> samples = exact_samples(truth, 12);
    Vector3<double> axis(normal(random), normal(random), normal(random));
    const Pose<double> stand{exp(Vector3<double>(3.0 * axis.normalized())),
                             {normal(random), normal(random), normal(random)}};
    for (Sample& sample : samples) {
      for (Feature& feature : sample.observations[1].features) {
        feature.frame = "stand";
        feature.point = stand.rotation.transpose() * (feature.point - stand.translation);
      }
    }
    const auto result = calibrate(OnAStand(), samples);
    ASSERT_TRUE(result.converged) << result.termination;
    EXPECT_LT(result.steps[0].final_cost, 1e-15) << "run " << run;
    EXPECT_NEAR(result.value<Elbow>(), truth[1], 1e-7);
  }
}

TEST(CalibrateCrate, APriorHoldsASingleParameterOfAJointModelOrASensor) {
  using Gear = JointModelParameters<"elbow", "gear_ratio">;
  using Depth = DepthCorrection<"camera">;
  using Kept = Crate<WithCamera, Gear, PriorOn<"keep_gear", "elbow_gear_ratio">,
                     PriorOn<"keep_depth", "camera_z_scaling">>;
  std::vector<Sample> samples = exact_samples({0.02, -0.03, 0.004, -0.005, 0.006}, 12);
  for (Sample& sample : samples) {
    CameraInfo info;
    info.k = {550, 0, 320, 0, 550, 240, 0, 0, 1};
    info.p = {550, 0, 320, 0, 0, 550, 240, 0, 0, 0, 1, 0};
    for (const char* joint : {"head_pan", "head_tilt"}) {
      sample.joint_names.emplace_back(joint);
      sample.joint_positions.push_back(0.1);
    }
    const Vector3<double> p(0.1, 0.2, 1.0);
    sample.observations.push_back({"camera", {{"", p}, {"", 1.1 * p}, {"", p + p}}, info});
  }
  Kept crate;
  crate.block<"hand_eye">().options.scale = 1e-3;
  crate.prior<"keep_gear">().mean[0] = 0.015;
  crate.prior<"keep_gear">().options.scale = 1e6;
  crate.prior<"keep_depth">().mean[0] = 0.025;
  crate.prior<"keep_depth">().joint_scale = 1e6;
  const auto result = calibrate(crate, samples);
  ASSERT_TRUE(result.converged) << result.termination;
  EXPECT_NEAR(result.value<Gear>(), 0.015, 1e-9);
  EXPECT_NEAR(result.value<Depth>()[1], 0.025, 1e-9);
  EXPECT_GT(std::abs(result.value<Depth>()[0]), 1e-3) << "this one is free";
}

TEST(CalibrateCrate, TakesTheOptionsOfItsBlocksAndOfSolving) {
  const std::vector<Sample> samples = exact_samples({0.02, -0.03, 0.004, -0.005, 0.006}, 12);
  Tracked crate;
  crate.block<"tracking">().options.scale = 10.0;
  SolveOptions options;
  options.max_num_iterations = 1;
  const auto one = calibrate(Tracked(), samples, options),
             weighted = calibrate(crate, samples, options);
  EXPECT_EQ(one.steps[0].iterations, 1);
  EXPECT_FALSE(one.converged);
  EXPECT_NEAR(weighted.steps[0].initial_cost, 100.0 * one.steps[0].initial_cost,
              1e-12 * weighted.steps[0].initial_cost);
}

TEST(CalibrateCrate, StartsFromTheValuesOfATableAndStaysWithinItsBounds) {
  const std::vector<double> truth = {0.02, -0.03, 0.004, -0.005, 0.006};
  const std::vector<Sample> samples = exact_samples(truth, 12);
  ParameterTable table = Tracked().table(samples);
  table["pan"].value = truth[0];
  table["elbow"].value = truth[1];
  const auto near = calibrate(Tracked(), table, samples), far = calibrate(Tracked(), samples);
  EXPECT_LT(near.steps[0].initial_cost, 0.5 * far.steps[0].initial_cost);
  EXPECT_NEAR(near.value<Elbow>(), truth[1], 1e-10);

  table["elbow"].lower = -0.01;
  table["elbow"].value = 0.0;
  const auto bounded = calibrate(Tracked(), table, samples);
  EXPECT_NEAR(bounded.value<Elbow>(), -0.01, 1e-12);
  EXPECT_GT(bounded.steps[0].final_cost, far.steps[0].final_cost);
}

TEST(CalibrateCrate, HoldsWhatTheSamplesSayNothingOf) {
  const std::vector<Sample> samples = exact_samples({0.02, -0.03, 0.004, -0.005, 0.006}, 12);
  const auto result = calibrate(WithCamera(), samples);
  ASSERT_TRUE(result.converged) << result.termination;
  EXPECT_EQ(result.steps[0].num_parameters, 5);
  EXPECT_EQ(result.value<DepthCorrection<"camera">>().norm(), 0.0);
  EXPECT_NEAR(result.value<Pan>(), 0.02, 1e-10);
}

TEST(CalibrateCrate, RefusesSamplesThatDoNotFit) {
  EXPECT_THROW((void)calibrate(Tracked(), {}), std::invalid_argument);
  std::vector<Sample> samples = exact_samples({0, 0, 0, 0, 0}, 3);
  samples[1].joint_names[1] = "pna";
  EXPECT_THAT(test::thrown<SampleError>([&] { (void)calibrate(Tracked(), samples); }),
              testing::HasSubstr("sample 1: joint 'pan' is not in the sample"));
  samples.resize(1);
  samples[0].observations.pop_back();
  EXPECT_THROW((void)calibrate(Tracked(), samples), std::invalid_argument) << "no tracker";
}

TEST(CalibrateCrate, TheValueOfATableIsTheStartAndWhatCountsAsInitial) {
  constexpr double kStart = 0.3;
  ParameterTable table = Tracked().table({});
  table["elbow"].value = kStart;
  const std::vector<Sample> samples = exact_samples({0.05, 0.4, 0, 0, 0}, 6);
  SolveOptions none;
  none.max_num_iterations = 0;
  EXPECT_EQ(calibrate(Tracked(), table, samples, none).table["elbow"].value, kStart);
  const auto result = calibrate(Tracked(), table, samples);
  EXPECT_EQ(result.table["elbow"].initial, kStart);
  EXPECT_NEAR(result.table["elbow"].value, 0.4, 1e-9);

  Calibration calibration = make_calibration(Tracked(), samples);
  calibration.table["elbow"].value = kStart;
  for (const Parameter& parameter : result.table) calibration.begin.push_back(parameter.value);
  const CalibrationResult again = calibrate(calibration);
  EXPECT_EQ(again.table["elbow"].initial, kStart);
  EXPECT_NEAR(again.steps.front().initial_cost, result.steps.front().final_cost, 1e-12);
}

}  // namespace
}  // namespace kinecal
