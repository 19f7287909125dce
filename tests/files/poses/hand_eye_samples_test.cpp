// Samples of MoveIt Calibration and easy_handeye2 are read; errors name line and sample.
#include "kinecal/files/poses/hand_eye_samples.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/poses/hand_eye_names.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// 0.1, 0.2, 0.3 m away, turned by a quarter about z.
constexpr const char* kQuarter = "[0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]";
constexpr const char* kIdentity = "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 1]";

std::string moveit(const std::string& flange, const std::string& object) {
  return fmt::format("- effector_wrt_world: {}\n  object_wrt_sensor: {}\n", flange, object);
}

/// One sample of easy_handeye2.
std::string easy(const std::string& type,
                 const std::string& rotation = "{x: 0, y: 0, z: 1, w: 0}") {
  return fmt::format(
      "parameters:\n  calibration_type: '{}'\nsamples:\n- robot:\n    translation: {{x: 0.1, y: "
      "0.2, "
      "z: 0.3}}\n    rotation: {}\n  tracking:\n    translation: {{x: 0, y: 0, z: 0.5}}\n    "
      "rotation: {{x: 0, y: 0, z: 0, w: 1}}\n",
      type, rotation);
}

class HandEyeSamples : public test::FolderTest {
 protected:
  std::vector<Sample> samples(const std::string& text, std::optional<bool> on_hand = {}) {
    write("samples.yaml", text);
    diagnostics_ = {};
    return read_hand_eye_samples(path(), on_hand, diagnostics_);
  }
  /// The errors of a text, without the path before them.
  std::vector<std::string> errors(const std::string& text, std::optional<bool> on_hand = {}) {
    (void)samples(text, on_hand);
    for (std::string& error : diagnostics_.errors) error.erase(0, path().size() + 1);
    return diagnostics_.errors;
  }
  [[nodiscard]] std::string path() const { return (folder_ / "samples.yaml").string(); }

  Diagnostics diagnostics_;
};

TEST_F(HandEyeSamples, OfMoveItAreReadByRows) {
  const std::vector<Sample> read =
      samples(moveit(kQuarter, kIdentity) + moveit(kIdentity, kQuarter));
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].source, path() + ":3");
  const Pose<double>& flange = read[0].poses.at(HandEyeNames::kFlangeJoint);
  EXPECT_EQ(flange.translation, Vector3<double>(0.1, 0.2, 0.3));
  EXPECT_NEAR(flange.rotation(1, 0), 1.0, 1e-15);
  const Observation* camera = read[1].observation(HandEyeNames::kCamera);
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->features[0].point, Vector3<double>(0.1, 0.2, 0.3));
  EXPECT_NEAR((*camera->features[0].rotation)(0, 1), -1.0, 1e-15);
}

TEST_F(HandEyeSamples, AreRecordingsAndNotPosesToCapture) {
  write("samples.yaml", moveit(kQuarter, kIdentity));
  EXPECT_TRUE(is_hand_eye_samples(path()));
  EXPECT_FALSE(is_poses_yaml(path()));
  Diagnostics diagnostics;
  EXPECT_EQ(read_recording(path(), diagnostics).samples.size(), 1u);
  write("samples.yaml", "- {joints: [a], positions: [1.0]}\n");
  EXPECT_FALSE(is_hand_eye_samples(path()));
  EXPECT_TRUE(is_poses_yaml(path()));
}

TEST_F(HandEyeSamples, OfEasyHandEyeHaveTheBaseInTheFlangeForACameraBesideTheRobot) {
  const auto flange = [&](const std::string& type, std::optional<bool> on_hand) {
    const std::vector<Sample> read = samples(easy(type), on_hand);
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    return read.at(0).poses.at(HandEyeNames::kFlangeJoint).translation;
  };
  const Vector3<double> as_read(0.1, 0.2, 0.3), inverse(0.1, 0.2, -0.3);
  EXPECT_LE((flange("", true) - as_read).norm(), 1e-15);
  EXPECT_LE((flange("eye_in_hand", {}) - as_read).norm(), 1e-15);
  EXPECT_LE((flange("", false) - inverse).norm(), 1e-15);
  EXPECT_LE((flange("eye_on_base", {}) - inverse).norm(), 1e-15);
  EXPECT_THAT(errors(easy("")), ElementsAre(HasSubstr("kinecal init --poses")));
  EXPECT_THAT(errors(easy("eye_on_base"), true),
              ElementsAre(HasSubstr("2: calibration_type is eye_on_base: the camera is beside")));
  EXPECT_THAT(errors(easy("", "{x: 0, y: 0, z: 3, w: 0}"), true),
              ElementsAre(HasSubstr("a unit quaternion has length 1, not 3")));
  EXPECT_THAT(errors(easy("", "{x: 0, y: 0, w: 0}"), true), ElementsAre(HasSubstr("z is missing")));
}

TEST_F(HandEyeSamples, NameLineSampleAndNumberOfWhatIsWrong) {
  const auto of = [&](const std::string& flange) {
    const auto found = errors(moveit(kIdentity, kIdentity) + moveit(flange, kIdentity));
    return found.size() == 1 ? found.front() : fmt::format("{} errors", found.size());
  };
  EXPECT_EQ(of("[1, 0, 0]"),
            "3: sample 2: effector_wrt_world has 3 numbers, not the 16 of a 4 x 4 matrix by rows");
  EXPECT_THAT(of("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, .nan, 0, 0, 0, 0, 1]"),
              HasSubstr("3: sample 2: effector_wrt_world: '.nan' is not a finite number"));
  EXPECT_THAT(of("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, .inf, 0, 0, 0, 0, 1]"),
              HasSubstr("'.inf' is not a finite number"));
  EXPECT_THAT(of("[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]"),
              HasSubstr("are not a rotation"));
  EXPECT_THAT(of("[1, 0, 0, 0, 0.3, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"),
              HasSubstr("are not a rotation"));
  EXPECT_THAT(of("[0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0.1, 0.2, 0.3, 1]"),
              HasSubstr("by rows, not by columns"));
  EXPECT_THAT(of("[1, 0, 0, 100, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"),
              HasSubstr("looks like millimetres; write metres"));
  EXPECT_THAT(of("abc"), HasSubstr("'abc', not a list"));
}

TEST_F(HandEyeSamples, NeedBothPosesAndReadableYaml) {
  const std::string one = fmt::format("- effector_wrt_world: {}\n", kIdentity);
  EXPECT_THAT(
      errors(moveit(kIdentity, kIdentity) + one),
      ElementsAre("3: sample 2: object_wrt_sensor is missing: each sample needs both poses"));
  EXPECT_THAT(errors("[]"), ElementsAre(HasSubstr("no samples")));
  EXPECT_THAT(errors("- [1, 2\n"), ElementsAre(HasSubstr("2:")));
  std::string many;
  for (int i = 0; i < 300; ++i) many += "- effector_wrt_world: [1]\n";
  EXPECT_LE(errors(many).size(), 25u);
  EXPECT_THAT(errors("- effector_wrt_world\n"), ElementsAre(HasSubstr("not a map")));
}

}  // namespace
}  // namespace kinecal
