#include "kinecal/tools/init/answers_from_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/paths.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Robot shipped_robot(const std::string& name) {
  return read_urdf(test::source_folder() + "/examples/robots/" + name + "/" + name + ".urdf");
}

/// Samples in which every joint of some names moves.
std::vector<Sample> moving(const std::vector<std::string>& joints,
                           const std::vector<Observation>& seen) {
  std::vector<Sample> samples(3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].joint_names = joints;
    samples[i].joint_positions.assign(joints.size(), 0.2 * static_cast<double>(i));
    samples[i].observations = seen;
    for (Observation& observation : samples[i].observations) {
      for (Feature& feature : observation.features) {
        if (observation.camera || observation.sensor == "laser") {
          feature.point.x() += 0.1 * static_cast<double>(i);
        }
      }
    }
  }
  return samples;
}

Observation board_of(const std::string& sensor, const std::string& frame) {
  return {sensor, {{frame, {0.0, 0.0, 0.0}}, {frame, {0.1, 0.0, 0.0}}}, {}};
}
Observation camera_of(const std::string& sensor, const std::string& frame, double z) {
  Observation seen{sensor, {{frame, {1.0, 2.0, z}}, {frame, {3.0, 2.0, z}}}, {}};
  seen.camera.emplace();
  return seen;
}

const std::vector<std::string> kFetchArm = {
    "shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
    "forearm_roll_joint", "wrist_flex_joint",    "wrist_roll_joint"};

TEST(AnswersFromSamples, TheArmThatMovesHoldsTheBoardElseItStands) {
  const Robot fetch = shipped_robot("fetch");
  const std::vector<Observation> seen = {board_of("holder", "my_board"),
                                         camera_of("eye", "head_camera_rgb_optical_frame", 0.0)};
  const InitAnswers held = answers_from_samples(fetch, moving(kFetchArm, seen), {});
  EXPECT_EQ(held.target, InitTarget::checkerboard);
  EXPECT_EQ(held.arm, "gripper_link");
  EXPECT_EQ(held.holder, "holder");
  EXPECT_EQ(held.target_frame, "my_board");
  EXPECT_EQ(held.camera_name, "eye");
  EXPECT_EQ(held.camera_type, "camera2d");
  EXPECT_FALSE(held.with_ground);
  const InitAnswers stands =
      answers_from_samples(fetch, moving({"head_pan_joint", "head_tilt_joint"}, seen), {});
  EXPECT_EQ(stands.target, InitTarget::world_checkerboard);
}

TEST(AnswersFromSamples, FeaturesInALinkAreLedsAndLonelyDepthIsTheFloor) {
  const Robot fetch = shipped_robot("fetch");
  std::vector<Sample> samples =
      moving(kFetchArm, {board_of("arm", "gripper_led_frame"),
                         camera_of("camera", "head_camera_rgb_optical_frame", 1.0)});
  EXPECT_EQ(answers_from_samples(fetch, samples, {}).target, InitTarget::leds);
  EXPECT_EQ(answers_from_samples(fetch, samples, {}).arm, "gripper_led_frame");
  samples.push_back(samples.back());
  samples.back().observations.erase(samples.back().observations.begin());
  EXPECT_TRUE(answers_from_samples(fetch, samples, {}).with_ground);
}

TEST(AnswersFromSamples, FixedPointsAreReflectorsOfATracker) {
  const Robot fetch = shipped_robot("fetch");
  const InitAnswers found = answers_from_samples(
      fetch, moving(kFetchArm, {board_of("laser", "world_of_laser"), board_of("ball", "smr")}), {});
  EXPECT_EQ(found.target, InitTarget::tracker);
  EXPECT_EQ(found.tracker, "laser");
  EXPECT_EQ(found.holder, "ball");
  EXPECT_EQ(found.tracker_frame, "world_of_laser");
  EXPECT_EQ(found.target_frame, "smr");
}

TEST(AnswersFromSamples, TheBaseIsWhereRecordedJointsBegin) {
  const Robot fetch = shipped_robot("fetch");
  const std::vector<Observation> seen = {board_of("holder", "my_board"),
                                         camera_of("eye", "head_camera_rgb_optical_frame", 0.0)};
  std::vector<std::string> joints = kFetchArm;
  joints.insert(joints.end(), {"head_pan_joint", "head_tilt_joint"});
  EXPECT_EQ(answers_from_samples(fetch, moving(joints, seen), {}).base, "torso_lift_link");
  joints.push_back("torso_lift_joint");
  EXPECT_EQ(answers_from_samples(fetch, moving(joints, seen), {}).base, "");
  std::erase(joints, "elbow_flex_joint");  // inside the arm: an error of the samples
  EXPECT_EQ(answers_from_samples(fetch, moving(joints, seen), {}).base, "");
}

TEST(AnswersFromSamples, AFeatureThatIsNotANumberIsPassedOver) {
  const Robot fetch = shipped_robot("fetch");
  std::vector<Sample> samples =
      moving(kFetchArm, {board_of("laser", "world_of_laser"), board_of("ball", "smr")});
  samples.front().observations[1].features[0].point.x() = std::nan("");
  EXPECT_EQ(answers_from_samples(fetch, samples, {}).holder, "ball");
}

TEST(AnswersFromSamples, NameWhatTheyLeaveOpen) {
  const Robot fetch = shipped_robot("fetch");
  const auto why = [&](const std::vector<Sample>& samples) -> std::string {
    return test::thrown<InputError>([&] { (void)answers_from_samples(fetch, samples, {}); }, "");
  };
  EXPECT_THAT(why({}), HasSubstr("there are no samples"));
  EXPECT_THAT(why(moving(kFetchArm, {board_of("arm", "board")})), HasSubstr("no camera"));
  EXPECT_THAT(why(moving(kFetchArm, {board_of("arm", "board"), board_of("table", "c")})),
              HasSubstr("'arm', 'table' are the same in all samples"));
  EXPECT_THAT(why(moving({"joint_a1"}, {board_of("laser", "l"), board_of("ball", "smr")})),
              HasSubstr("none of the joints of the samples (joint_a1, ...) is in the URDF"));
  const Observation blind{"laser", {{"optical", {310.0, 2.0, 0.0}}}, {}};  // it moves
  EXPECT_THAT(
      why(moving(kFetchArm, {board_of("arm", "board"), blind})),
      AllOf(HasSubstr("sensor 'laser' has no camera_info"), HasSubstr("--camera laser=FILE")));
  const Observation eye = camera_of("eye", "head_camera_rgb_optical_frame", 0.0);
  EXPECT_THAT(why(moving(kFetchArm, {board_of("arm", "b"), eye, camera_of("other", "o", 0.0)})),
              HasSubstr("several cameras, 'eye', 'other'"));
  EXPECT_THAT(why(moving(kFetchArm, {board_of("arm", "b"), board_of("table", "c"), eye})),
              HasSubstr("'arm', 'table'"));
  EXPECT_THAT(why(moving(kFetchArm, {board_of("arm", "b"), camera_of("eye", "nowhere", 0.0)})),
              HasSubstr("--camera: the features of camera 'eye' are in frame 'nowhere'"));
}

}  // namespace
}  // namespace kinecal
