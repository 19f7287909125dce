#include "kinecal/procedure/calibrate_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/procedure/calibrated_files.hpp"
#include "support/arm_scene.hpp"

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
  try {
    (void)calibrate_robot(setup, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
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
