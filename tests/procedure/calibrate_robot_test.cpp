#include "kinecal/procedure/calibrate_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kinecal/procedure/calibrated_files.hpp"
#include "support/arm_scene.hpp"
#include "support/real_recordings.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

CalibrationSetup arm_setup(int count) {
  Diagnostics found;
  CalibrationSetup setup{.robot = parse_urdf(test::kArmUrdf, "arm.urdf"),
                         .config = parse_config(test::kArmConfig, "calibrate.yaml", found),
                         .urdf_text = test::kArmUrdf,
                         .urdf = "arm.urdf"};
  setup.samples = test::arm_samples(setup.robot, count);
  return setup;
}

std::string input_error(const CalibrationSetup& setup, const CalibrationOptions& options = {}) {
  return test::thrown<InputError>([&] { (void)calibrate_robot(setup, options); }, "");
}

TEST(CalibrateRobot, FindsTheErrorsOfARobotAndGivesItsUrdf) {
  const CalibratedRobot calibrated = calibrate_robot(arm_setup(30));
  ASSERT_EQ(calibrated.judgement.verdict, Grade::good) << calibrated.judgement.reasons.front();
  EXPECT_TRUE(calibrated.is_usable());
  EXPECT_NEAR(calibrated.result.table["lift"].value, 0.02, 2e-4);
  EXPECT_NEAR(calibrated.result.table["elbow"].value, -0.03, 2e-4);
  EXPECT_EQ(calibrated.samples.size(), 30u);
  EXPECT_THAT(next_step(calibrated), HasSubstr("verify"));
  EXPECT_THAT(calibrated_urdf(calibrated), HasSubstr("<calibration rising="));
  EXPECT_EQ(calibrated_files(calibrated).front().name, "calibrated.urdf");
}

TEST(CalibrateRobot, NumbersSamplesFromOne) {
  CalibrationSetup setup = arm_setup(30);
  for (Feature& feature : setup.samples[4].observations[1].features) feature.point.x() += 0.05;
  const CalibratedRobot calibrated = calibrate_robot(setup, {.exclude = {1}});
  ASSERT_EQ(calibrated.left_out.size(), 2u);
  EXPECT_EQ(calibrated.left_out[0].number, 1);
  EXPECT_EQ(calibrated.left_out[1].number, 5);
  EXPECT_EQ(calibrated.left_out_samples[1].source, setup.samples[4].source);
  EXPECT_EQ(calibrated.numbers.front(), 2);
  EXPECT_THAT(input_error(setup, {.exclude = {31}}), HasSubstr("there are samples 1 to 30"));
}

TEST(CalibrateRobot, NamesTheCauseOfABadFit) {
  CalibrationSetup setup = arm_setup(30);
  for (Sample& sample : setup.samples) {
    for (Feature& feature : sample.observations[1].features) feature.point *= 1.05;
  }
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::do_not_use);
  EXPECT_GE(calibrated.judgement.causes, 1);
  EXPECT_THAT(calibrated.judgement.reasons.front(), HasSubstr("points of 'tracker'"));
}

/// A calibration whose configuration says where the tracker is; it is at 0.7 -0.4 0.2.
CalibratedRobot with_tracker_at(const std::string& x) {
  Diagnostics found;
  CalibrationSetup setup = arm_setup(30);
  setup.config = parse_config(test::kArmConfig +
                                  "free_frames_initial_values:\n - {name: tracker_frame, x: " + x +
                                  ", y: -0.4, z: 0.2, roll: 0.1, pitch: -0.2, yaw: 0.7}\n",
                              "calibrate.yaml", found);
  return calibrate_robot(std::move(setup));
}

TEST(CalibrateRobot, DoubtsAFrameThatEndsFarFromWhereSomebodySaidItIs) {
  EXPECT_EQ(with_tracker_at("0.6").judgement.verdict, Grade::good);
  const CalibratedRobot far = with_tracker_at("-0.7");
  EXPECT_EQ(far.judgement.verdict, Grade::use_with_care);
  EXPECT_THAT(far.judgement.reasons.front(),
              HasSubstr("'tracker_frame' ended 1.4 m from where the configuration says it is"));
  EXPECT_THAT(next_step(far), HasSubstr("initial value of 'tracker_frame'"));
}

/// Half a turn of the frame's guess leads to the mirror image of the robot, which fits as well.
TEST(CalibrateRobot, TakesTheRobotOfTheUrdfWhereItsMirrorImageFitsAsWell) {
  KINECAL_NEEDS_DATA("mukca_panda");
  test::Recording panda = test::recording("panda");
  FrameInitialValueConfig& fixture = panda.config.steps.back().frame_initial_values.at(0);
  ASSERT_EQ(fixture.name, "fixture_frame");
  fixture.rpy.z() -= std::numbers::pi;
  const CalibratedRobot calibrated = calibrate_robot(test::setup_of(panda));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good) << calibrated.judgement.reasons.front();
  EXPECT_NEAR(calibrated.result.table["fixture_frame_x"].value, 0.42, 0.01);
  EXPECT_LE(std::abs(calibrated.result.table["panda_joint6_y"].value), 0.02);
  EXPECT_EQ(calibrated.result.steps.back().starts.given, std::vector<std::string>{"fixture_frame"});
}

/// A reflector at the origin of its frame, whose turn nothing shows.
TEST(CalibrateRobot, ConvergesThoughATurnHasNoEffect) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  test::Recording ur5 = test::recording("ur5_offsets");
  FreeFrameConfig& reflector = ur5.config.steps.back().free_frames.at(1);
  ASSERT_EQ(reflector.name, "smr");
  reflector.axes.fill(true);
  const CalibratedRobot calibrated = calibrate_robot(test::setup_of(ur5));
  EXPECT_TRUE(calibrated.result.converged) << calibrated.result.termination;
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good) << calibrated.judgement.reasons.front();
  EXPECT_EQ(calibrated.assessments.back().observability.unobservable.size(), 3u);
}

TEST(CalibrateRobot, NamesAFileThatDisagreesWithTheOthers) {
  CalibrationSetup setup = arm_setup(60);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 3e-4);
  for (std::size_t i = 0; i < setup.samples.size(); ++i) {
    Sample& sample = setup.samples[i];
    sample.source = "abc"[i % 3] + std::string(".yaml:") + std::to_string(i + 1);
    if (i % 3 != 1) continue;
    for (Feature& feature : sample.observations[1].features) {
      for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
    }
  }
  std::stable_sort(setup.samples.begin(), setup.samples.end(),
                   [](const Sample& a, const Sample& b) { return a.source[0] < b.source[0]; });
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup), {.keep_outliers = true});
  EXPECT_THAT(calibrated.judgement.reasons,
              testing::Contains(HasSubstr("b.yaml: its residuals are")));
}

TEST(CalibrateRobot, SaysAllErrorsOfTheInputAtOnce) {
  CalibrationSetup setup = arm_setup(30);
  setup.config->steps[0].models[0].frame = "tooll";
  setup.config->steps[0].free_params[0].name = "liftt";
  const std::string what = input_error(setup);
  EXPECT_THAT(what, HasSubstr("did you mean 'tool'"));
  EXPECT_THAT(what, HasSubstr("did you mean 'lift'"));
  EXPECT_THAT(input_error(arm_setup(1)), HasSubstr("sample"));
}

/// Before it is solved: no iteration runs.
TEST(CalibrateRobot, RefusesZerosThatTheUrdfHasNoPlaceFor) {
  int iterations = 0;
  CalibrationOptions options;
  options.offsets = OffsetStyle::ros2_control;
  options.progress = [&](const std::string&, int, double) { ++iterations; };
  EXPECT_THAT(input_error(arm_setup(30), options),
              HasSubstr("arm.urdf: <ros2_control> has no joint"));
  EXPECT_EQ(iterations, 0);
  options.in_servos = {"lift", "elbow", "roll", "flex"};  // no zero is left for the URDF
  EXPECT_EQ(input_error(arm_setup(30), options), "");
}

struct Enough {};

TEST(CalibrateRobot, EndsWithWhatItsProgressThrows) {
  int iterations = 0;
  CalibrationOptions options;
  options.progress = [&](const std::string&, int, double) {
    if (++iterations == 2) throw Enough();
  };
  EXPECT_THROW((void)calibrate_robot(arm_setup(30), options), Enough);
  EXPECT_EQ(iterations, 2);
}

}  // namespace
}  // namespace kinecal
