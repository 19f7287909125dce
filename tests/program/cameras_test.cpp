// kinecal init --cameras, as users call it: corners of a board that somebody held, and nothing else.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <random>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A wide camera that saw a board 30 times.
class CamerasProgram : public test::ProgramTest {
 protected:
  /// @param far  samples from this one on have another image size
  static std::string samples(int far = 1000) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> side(-0.5, 0.5), tilt(-0.6, 0.6);
    std::normal_distribution<double> noise(0.0, 0.1);  // pixels
    const std::array<double, 4> lens = {0.02, -0.004, 0.0, 0.0};
    std::string text;
    for (int n = 0; n < 30; ++n) {
      const Pose<double> camera_T_board{
          rotation_from_rpy({tilt(random), tilt(random), 3.0 * tilt(random)}),
          {side(random) - 0.15, side(random) - 0.1, 0.45 + 0.3 * side(random)}};
      std::string board, seen;
      for (int i = 0; i < 54; ++i) {
        const Vector3<double> corner(0.035 * (i % 9), 0.035 * (i / 9), 0.0);
        const Eigen::Vector2d at =
            Equidistant::image(Vector3<double>(camera_T_board * corner), lens);
        board += fmt::format("  - {{header: {{frame_id: board}}, point: {{x: {}, y: {}, z: 0}}}}\n",
                             corner.x(), corner.y());
        seen += fmt::format("  - {{header: {{frame_id: camera}}, point: {{x: {}, y: {}, z: 0}}}}\n",
                            640 + 380 * at.x() + noise(random), 500 + 381 * at.y() + noise(random));
      }
      text += fmt::format(
          "joint_states: {{name: [], position: []}}\nobservations:\n- sensor_name: board\n  "
          "features:\n{}- sensor_name: camera\n  features:\n{}  ext_camera_info: {{camera_info: "
          "{{width: {}, height: 960}}}}\n---\n",
          board, seen, n < far ? 1280 : 640);
    }
    return text;
  }
  [[nodiscard]] bool exists(const char* name) const {
    return std::filesystem::exists(folder_ / name);
  }
};

TEST_F(CamerasProgram, FindAFisheyeFromCornersAlone) {
  write("samples.yaml", samples());
  const test::Outcome init = kinecal("init --cameras camera --target checkerboard");
  ASSERT_EQ(init.code, 0) << init.err;
  EXPECT_THAT(init.out,
              HasSubstr("next: kinecal detect capture.yaml --images images --frame camera"));
  EXPECT_THAT(read("capture.yaml"), HasSubstr("chain_sensor_name: board"));
  const test::Outcome done =
      kinecal("calibrate --config calibrate.yaml --samples samples.yaml --output calibrated");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.err, HasSubstr("lens by the error on views held out"));
  EXPECT_THAT(done.out, Not(HasSubstr("kinecal verify")));
  EXPECT_THAT(read("calibrated/rgb_camera.yaml"),
              testing::AnyOf(HasSubstr("distortion_model: equidistant"),
                             HasSubstr("distortion_model: double_sphere")));
  EXPECT_THAT(read("calibrated/report.json"), HasSubstr("\"lenses\""));
  const test::Outcome verify = kinecal("verify calibrated samples.yaml");
  EXPECT_EQ(verify.code, 1);
  EXPECT_THAT(verify.err, HasSubstr("has a pose of its own in each sample"));
}

TEST_F(CamerasProgram, AGivenLensAndItsCoefficients) {
  write("samples.yaml", samples());
  write("cameras.yaml",
        "base_link: camera\nper_sample: [board]\nmodels:\n - {name: board, type: chain3d, frame: "
        "board}\n - {name: camera, type: camera2d, frame: camera, lens: fisheye}\nfree_params: "
        "[camera_fx, camera_fy, camera_cx, camera_cy, camera_k1, camera_k2]"
        "\nerror_blocks:\n - {name: corners, type: chain3d_to_camera2d, model_3d: board, "
        "model_2d: camera}\n");
  const test::Outcome done =
      kinecal("calibrate --config cameras.yaml --samples samples.yaml --output calibrated");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(read("calibrated/rgb_camera.yaml"), HasSubstr("distortion_model: equidistant"));
  const test::Outcome camera =
      kinecal("camera calibrated/rgb_camera.yaml --output kalibr.yaml --keys kalibr");
  ASSERT_EQ(camera.code, 0) << camera.err;
  EXPECT_THAT(read("kalibr.yaml"),
              AllOf(HasSubstr("cam0:"), HasSubstr("distortion_model: equidistant")));
}

TEST_F(CamerasProgram, SaysWhatCannotBe) {
  write("samples.yaml", samples(20));
  ASSERT_EQ(kinecal("init --cameras camera --target checkerboard").code, 0);
  const test::Outcome sizes =
      kinecal("calibrate --config calibrate.yaml --samples samples.yaml --output calibrated");
  EXPECT_EQ(sizes.code, 1);
  EXPECT_THAT(sizes.err, HasSubstr("images of two sizes: 1280x960"));
  EXPECT_FALSE(exists("calibrated"));
  const test::Outcome target = kinecal("init --cameras camera --target leds");
  EXPECT_EQ(target.code, 1);
  EXPECT_THAT(target.err, HasSubstr("checkerboard, apriltag or charuco"));
  const test::Outcome twice = kinecal("init --cameras a,a --target checkerboard -o two.yaml");
  EXPECT_EQ(twice.code, 1);
  EXPECT_FALSE(exists("two.yaml"));
}

}  // namespace
}  // namespace kinecal
