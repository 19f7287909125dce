// kinecal detect --every as users meet it: recordings of a robot that moves slowly give the lag of its
// camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "support/paths.hpp"
#include "support/recording.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::HasSubstr;
using testing::Not;

constexpr int kRecordings = 3, kImages = 11;  // of each recording; the last one at rest
constexpr double kInterval = 0.4;             // seconds between images
constexpr double kImageLag = 0.020;           // seconds by which images are later than their stamps
constexpr double kSwing = 0.08, kRate = 1.6;  // radians, rad/s

class DetectMotion : public test::ProgramTest {
 protected:
  DetectMotion() {
    fs::copy(fs::path(test::source_folder()) / "examples/robots/panda/panda.urdf", folder_);
  }

  /// Swings about the pose of a recording.
  [[nodiscard]] double position(int recording, std::size_t joint, double time) const {
    return poses_[static_cast<std::size_t>(recording)].positions[joint] +
           kSwing * std::sin(kRate * time + static_cast<double>(joint));
  }
  [[nodiscard]] static double velocity(std::size_t joint, double time) {
    return kSwing * kRate * std::cos(kRate * time + static_cast<double>(joint));
  }
  [[nodiscard]] static double time_of(int image) {
    return image + 1 < kImages ? 0.2 + kInterval * image : kInterval * image;
  }

  /// Renders what the camera sees on the way, of a robot that is as its URDF says.
  void render() {
    const std::string scene =
        "seed: 1\ntarget: {type: apriltag}\nerrors: {joint: 0, sliding: 0, "
        "position: 0, rotation: 0, intrinsics: 0}\n"
        // Joints that do not repeat are no lag.
        "motion: {encoder_noise: 0, repeatability: 0, backlash: 0}\n";
    write("still.yaml", scene + "poses: 3\n");
    ASSERT_EQ(kinecal("simulate panda.urdf --scene still.yaml -o still").code, 0);
    Diagnostics diagnostics;
    poses_ = read_poses_yaml((folder_ / "still/poses.yaml").string(), diagnostics);
    diagnostics.throw_if_errors();
    ASSERT_EQ(poses_.size(), std::size_t{kRecordings});
    std::string list;
    for (int n = 0; n < kRecordings * kImages; ++n) {
      std::string names, positions;
      for (std::size_t j = 0; j < poses_[0].joint_names.size(); ++j) {
        const char* comma = j == 0 ? "" : ", ";
        names += comma + poses_[0].joint_names[j];
        positions += comma + std::to_string(position(n / kImages, j, time_of(n % kImages)));
      }
      list += "- joints: [" + names + "]\n  positions: [" + positions + "]\n  features: []\n";
    }
    write("path.yaml", list);
    write("scene.yaml", scene + "poses: path.yaml\n");
    const Outcome made = kinecal("simulate panda.urdf --scene scene.yaml -o photos");
    ASSERT_EQ(made.code, 0) << made.err;
  }

  /// Joint states at 50 Hz, and images whose stamps are too early by the lag; at the end the robot
  /// rests for a second.
  void record(int recording) {
    test::Recorder to((folder_ / (std::to_string(recording) + ".mcap")).string(), Encoding::cdr);
    to.camera_ahead = -std::chrono::round<Stamp>(std::chrono::duration<double>(kImageLag));
    Diagnostics diagnostics;
    to.camera_info("/eye/camera_info", test::kTourStart,
                   read_camera_file((folder_ / "photos/camera.yaml").string(), diagnostics));
    const double end = time_of(kImages - 1);
    for (int n = 0; n <= static_cast<int>(50.0 * (end + 1.0)); ++n) {
      const double time = 0.02 * n, moved = std::min(time, end);
      std::vector<double> positions;
      for (std::size_t j = 0; j < poses_[0].joint_names.size(); ++j) {
        positions.push_back(position(recording, j, moved) + 5e-5 * std::sin(1e4 * time));
      }
      const Stamp stamp = test::kTourStart + std::chrono::milliseconds(20 * n);
      to.joints("/joint_states", {stamp, poses_[0].joint_names, positions});
      if (n % 20 != 10) continue;
      const int image = std::min(n / 20, kImages - 1);
      char name[16];
      std::snprintf(name, sizeof name, "%04d.png", recording * kImages + image + 1);
      to.image("/eye/image", stamp, decode_image(read(fs::path("photos/images") / name), name));
    }
    to.finish();
  }

  std::vector<CapturePose> poses_;
};

#if defined(KINECAL_HAVE_PNG) && defined(KINECAL_HAVE_APRILTAG)
TEST_F(DetectMotion, GivesSamplesWithVelocitiesAndTheLagOfTheCamera) {
  ASSERT_NO_FATAL_FAILURE(render());
  for (int recording = 0; recording < kRecordings; ++recording) record(recording);
  const Outcome found = kinecal(
      "detect photos/capture.yaml --bag 0.mcap --bag 1.mcap --bag 2.mcap --every 0.4 "
      "--urdf panda.urdf --frame camera_color_optical_frame -o samples.yaml");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr(" views: "));
  EXPECT_THAT(found.out, HasSubstr("the robot moved at 0.1"));
  EXPECT_THAT(found.out,
              HasSubstr("free that of what moves, camera_lag, board_lag (kinecal identify does)"));
  EXPECT_THAT(found.err, HasSubstr("0.mcap: left out "));
  EXPECT_THAT(found.err, Not(HasSubstr("single image")));
  const std::vector<Sample> seen = test::samples_in(folder_ / "samples.yaml");
  EXPECT_LE(seen.size(), std::size_t{kRecordings * kImages});
  EXPECT_GE(seen.size(), std::size_t{kRecordings * kImages * 9 / 10});
  for (const Sample& sample : seen) {
    const double time = std::chrono::duration<double>(*sample.stamp - test::kTourStart).count();
    ASSERT_EQ(sample.joint_velocities.size(), poses_[0].joint_names.size());
    if (time > time_of(kImages - 1) - 0.1) continue;  // where it stops
    for (std::size_t j = 0; j < poses_[0].joint_names.size(); ++j) {
      EXPECT_NEAR(sample.velocity(poses_[0].joint_names[j]).value(), velocity(j, time), 1e-2);
    }
  }
  write(
      "lag.yaml",
      "base_link: panda_link0\nmodels:\n"
      " - {name: board, type: chain3d, frame: panda_link0}\n"
      " - {name: camera, type: camera2d, frame: camera_color_optical_frame}\n"
      "free_params: [camera_lag]\nfree_frames:\n"
      " - {name: checkerboard, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\n"
      "error_blocks:\n"
      " - {name: eye, type: chain3d_to_camera2d, model_3d: board, model_2d: camera, sigma: 0.5}\n");
  const Outcome calibrated =
      kinecal("calibrate --config lag.yaml --urdf panda.urdf --samples samples.yaml --output out");
  EXPECT_EQ(calibrated.code, 0) << calibrated.out << calibrated.err;
  const std::string result = read("out/calibration.yaml");
  const std::size_t at = result.find("camera_lag:");
  ASSERT_NE(at, std::string::npos) << result;
  EXPECT_NEAR(std::stod(result.substr(at + 11)), kImageLag, 2e-4);
}
#endif

TEST_F(DetectMotion, NeedsARecordingAndAnInterval) {
  write("capture.yaml",
        "features:\n  board:\n    type: robot_calibration/CheckerboardFinder2d\n    topic: /eye\n");
  const std::string detect = "detect capture.yaml -o s.yaml ";
  EXPECT_THAT(kinecal(detect + "--every 0.5").err, HasSubstr("--every requires --bag"));
  for (const std::string wrong : {"0", "-1", "nan", "inf", "1e9"}) {
    const Outcome refused = kinecal(detect + "--bag a.mcap --every " + wrong);
    EXPECT_NE(refused.code, 0) << wrong;
    EXPECT_THAT(refused.err, HasSubstr("--every takes 0.001 to 3600 seconds, is ")) << wrong;
  }
  EXPECT_THAT(kinecal(detect + "--bag a.mcap --every 0.5 --restless torso").err,
              HasSubstr("--restless names joints that need not stand still in standstills"));
}

}  // namespace
}  // namespace kinecal
