#include "kinecal/procedure/judge_read_back.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/report/next_step.hpp"
#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The arm, with a gear of the elbow that is a hundredth off and is free.
CalibrationSetup arm_setup(double gear, const std::string& urdf = test::kArmUrdf) {
  std::string config = test::kArmConfig;
  if (gear != 0.0) config.replace(config.find("free_frames"), 0, " - elbow_gear_ratio\n");
  Diagnostics found;
  CalibrationSetup setup{.robot = parse_urdf(urdf, "arm.urdf"),
                         .config = parse_config(config, "calibrate.yaml", found),
                         .urdf_text = urdf,
                         .urdf = "arm.urdf"};
  setup.samples = test::arm_samples(setup.robot, 40);
  for (Sample& sample : setup.samples) sample.joint_positions[2] /= 1.0 + gear;
  return setup;
}

double error_for(Reader reader, const CalibratedRobot& calibrated) {
  const ReaderFit* fit = calibrated.read_back.of(reader);
  return fit == nullptr ? -1.0 : fit->errors.front().rms;
}

TEST(JudgeReadBack, FilesAreAsGoodAsTheFitIfTheyHoldAllOfIt) {
  for (const OffsetStyle style : {OffsetStyle::as_read, OffsetStyle::origin}) {
    const CalibratedRobot calibrated = calibrate_robot(arm_setup(0.0), {.offsets = style});
    ASSERT_EQ(calibrated.judgement.verdict, Grade::good) << calibrated.judgement.reasons.front();
    const double fitted = calibrated.result.blocks.front().after.rms;
    EXPECT_NEAR(error_for(Reader::driver, calibrated), fitted, 1e-9 * fitted);
    EXPECT_NEAR(error_for(Reader::urdf, calibrated), fitted, 1e-6 * fitted);
    EXPECT_THAT(calibrated.read_back.lost, ElementsAre());
    EXPECT_EQ(read_back_text(calibrated.read_back).empty(), style == OffsetStyle::origin);
  }
}

TEST(JudgeReadBack, ShowsWhatIsSeenWithoutRising) {
  const CalibratedRobot calibrated = calibrate_robot(arm_setup(0.0));
  EXPECT_GT(error_for(Reader::origins, calibrated), 2e-3);
  EXPECT_THAT(read_back_text(calibrated.read_back), HasSubstr("--offsets origin"));
  const CalibratedRobot unread = calibrate_robot(arm_setup(0.0), {.reader = Reader::origins});
  EXPECT_NE(unread.judgement.verdict, Grade::good);
  EXPECT_THAT(unread.judgement.reasons.front(), HasSubstr("<calibration rising> is not read"));
  EXPECT_THAT(next_step(unread), HasSubstr("origins"));
}

TEST(JudgeReadBack, TakesRisingForReadWhereTheUrdfHasIt) {
  std::string urdf = test::kArmUrdf;
  const std::string axis = "<axis xyz=\"0 0 1\"/>";
  urdf.replace(urdf.find(axis), axis.size(), axis + "<calibration rising=\"0\"/>");
  const CalibratedRobot calibrated = calibrate_robot(arm_setup(0.0, urdf));
  EXPECT_EQ(error_for(Reader::origins, calibrated), -1.0);
  EXPECT_EQ(read_back_text(calibrated.read_back), "");
}

TEST(JudgeReadBack, JudgesTheUrdfWithoutTheGearThatItCannotHold) {
  const CalibratedRobot calibrated = calibrate_robot(arm_setup(0.01));
  const double fitted = calibrated.result.blocks.front().after.rms;
  EXPECT_LT(fitted, 2e-4);
  EXPECT_GT(error_for(Reader::urdf, calibrated), 10.0 * fitted);
  EXPECT_THAT(calibrated.read_back.lost, ElementsAre("elbow_gear_ratio"));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::use_with_care);
  EXPECT_THAT(calibrated.judgement.reasons, ElementsAre(HasSubstr("the URDF alone leaves")));
  EXPECT_THAT(calibrated.judgement.reasons.front(), HasSubstr("'elbow_gear_ratio'"));
  // What is proposed was tried.
  const CalibratedRobot geometry =
      calibrate_robot(arm_setup(0.01), {.search = Search::always, .geometry_only = true});
  ASSERT_FALSE(calibrated.read_back.geometry_only.empty());
  EXPECT_NEAR(calibrated.read_back.geometry_only.front().rms, error_for(Reader::urdf, geometry),
              0.02 * error_for(Reader::urdf, geometry));
  EXPECT_LT(error_for(Reader::urdf, geometry), error_for(Reader::urdf, calibrated));
  EXPECT_THAT(next_step(calibrated), HasSubstr("find what a URDF holds"));
}

TEST(JudgeReadBack, ADriverThatAppliesTheGearHasAGoodResult) {
  const CalibratedRobot calibrated = calibrate_robot(arm_setup(0.01), {.reader = Reader::driver});
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good) << calibrated.judgement.reasons.front();
  EXPECT_GT(error_for(Reader::urdf, calibrated), 1e-3) << "it is said for others";
  EXPECT_THAT(read_back_text(calibrated.read_back), HasSubstr("true_position.hpp"));
}

TEST(JudgeReadBack, WithoutTheTextOfAUrdfThereIsNothingToRead) {
  CalibrationSetup setup = arm_setup(0.01);
  setup.urdf_text.clear();
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup));
  EXPECT_TRUE(calibrated.read_back.fits.empty());
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good) << calibrated.judgement.reasons.front();
}

}  // namespace
}  // namespace kinecal
