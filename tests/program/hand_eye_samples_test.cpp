// kinecal init --poses of samples that MoveIt Calibration saved, as users call it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "kinecal/files/poses/pose_numbers.hpp"
#include "support/hand_eye_poses.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using test::FlangeTurns;
using test::HandEyePoses;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class HandEyeSamplesProgram : public test::ProgramTest {
 protected:
  static constexpr const char* kCalibrate =
      "calibrate --urdf hand_eye.urdf --config calibrate.yaml --output calibrated --samples ";

  [[nodiscard]] Pose<double> found() const {
    std::istringstream in(read("calibrated/camera_joint.txt"));
    std::vector<double> numbers;
    for (double number = 0.0; in >> number;) numbers.push_back(number);
    return pose_from_numbers(*pose_form("matrix"), numbers).pose;
  }
};

TEST_F(HandEyeSamplesProgram, OfMoveItAreCalibratedWithoutAGuess) {
  for (const bool on_hand : {true, false}) {
    const HandEyePoses poses(on_hand, 15, 5);
    write("samples.yaml", poses.moveit_text());
    const test::Outcome init = kinecal(std::string("init --force --poses samples.yaml --target ") +
                                       (on_hand ? "world_marker" : "marker"));
    ASSERT_EQ(init.code, 0) << init.err;
    EXPECT_THAT(init.out, HasSubstr("15 poses of the flange and of the object"));
    for (const char* samples : {"samples.yaml", "hand_eye_samples.yaml"}) {
      const test::Outcome done = kinecal(std::string(kCalibrate) + samples + " --force");
      ASSERT_EQ(done.code, 0) << done.err;
      EXPECT_THAT(done.out, HasSubstr("verdict: good"));
      EXPECT_LE((found().translation - poses.mount.translation).norm(), 8e-3);
      EXPECT_LE((found().rotation - poses.mount.rotation).norm(), 1e-2);
    }
    EXPECT_THAT(read("calibrated/camera_joint.launch.py"),
                HasSubstr(on_hand ? "\"--frame-id\",\n                \"flange\""
                                  : "\"--frame-id\",\n                \"base_link\""));
  }
}

TEST_F(HandEyeSamplesProgram, DoubtATargetThatTheyDoNotFit) {
  for (const bool on_hand : {true, false}) {
    write("samples.yaml", HandEyePoses(on_hand, 12, 8).moveit_text());
    const std::string right = on_hand ? "world_marker" : "marker",
                      wrong = on_hand ? "marker" : "world_marker";
    const std::string init = "init --force --poses samples.yaml --target ";
    EXPECT_THAT(kinecal(init + wrong).err, HasSubstr("is --target " + right + " meant?"));
    EXPECT_THAT(kinecal(init + right).err, Not(HasSubstr("meant")));
  }
}

TEST_F(HandEyeSamplesProgram, ThatTurnAboutOneAxisAreNotGood) {
  for (const FlangeTurns turns : {FlangeTurns::one_axis, FlangeTurns::none}) {
    write("samples.yaml", HandEyePoses(true, 15, 6, turns).moveit_text());
    ASSERT_EQ(kinecal("init --force --poses samples.yaml --target world_marker").code, 0);
    const test::Outcome done = kinecal(std::string(kCalibrate) + "samples.yaml --force");
    const bool is_open = turns == FlangeTurns::none;  // in all directions, not along one axis only
    EXPECT_THAT(done.out, HasSubstr(is_open ? "verdict: do not use" : "verdict: use with care"));
    EXPECT_EQ(done.code, is_open ? 2 : 0);
    EXPECT_THAT(done.out + done.err, HasSubstr(turns == FlangeTurns::none
                                                   ? "record poses that turn about two axes"
                                                   : "record poses that turn about a second axis"));
  }
}

TEST_F(HandEyeSamplesProgram, NeedAWordForWhereTheCameraIsAndWriteNothingWithErrors) {
  write("samples.yaml", HandEyePoses(true, 5, 7).moveit_text());
  const test::Outcome no_target = kinecal("init --poses samples.yaml");
  EXPECT_EQ(no_target.code, 1);
  EXPECT_THAT(no_target.err, AllOf(HasSubstr("--target"), HasSubstr("world_marker")));
  write("samples.yaml", "- effector_wrt_world: [1, 2]\n");
  const test::Outcome wrong = kinecal("init --poses samples.yaml --target marker");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err,
              AllOf(HasSubstr("samples.yaml:1: sample 1: effector_wrt_world has 2 numbers"),
                    HasSubstr("object_wrt_sensor is missing")));
  for (const char* file : {"hand_eye.urdf", "calibrate.yaml", "hand_eye_samples.yaml"}) {
    EXPECT_FALSE(std::filesystem::exists(folder_ / file)) << file;
  }
}

}  // namespace
}  // namespace kinecal
