// kinecal init --cameras, as users call it: corners of a board that somebody held, and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/run_program.hpp"
#include "support/wide_camera.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A wide camera that saw a board 30 times.
class CamerasProgram : public test::ProgramTest {
 protected:
  [[nodiscard]] bool exists(const char* name) const {
    return std::filesystem::exists(folder_ / name);
  }
};

TEST_F(CamerasProgram, FindAFisheyeFromCornersAlone) {
  write("samples.yaml", test::wide_camera_samples());
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

/// The search begins elsewhere with other photographs, and parameters count from there: cameras are compared as their
/// files have them.
TEST_F(CamerasProgram, AreComparedByTheirNumbers) {
  const std::string all = test::wide_camera_samples();
  std::size_t half = 0;
  for (int i = 0; i < 14; ++i) half = all.find("---", half + 3);
  write("samples.yaml", all);
  write("half.yaml", all.substr(0, half + 4));
  ASSERT_EQ(kinecal("init --cameras camera --target checkerboard").code, 0);
  for (const std::string& name : std::vector<std::string>{"samples", "half"}) {
    const test::Outcome done = kinecal("calibrate --config calibrate.yaml --samples " + name +
                                       ".yaml --output of_" + name);
    ASSERT_EQ(done.code, 0) << done.out << done.err;
  }
  const test::Outcome compared = kinecal("compare of_samples of_half");
  EXPECT_EQ(compared.code, 0) << compared.out << compared.err;
  EXPECT_THAT(compared.out, testing::AnyOf(HasSubstr("0 of "), HasSubstr("is of lens")));
}

TEST_F(CamerasProgram, AGivenLensAndItsCoefficients) {
  write("samples.yaml", test::wide_camera_samples());
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
  write("samples.yaml", test::wide_camera_samples(20));
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
