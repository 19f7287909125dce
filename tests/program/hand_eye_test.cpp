// kinecal init --poses, as users call it: tables in, URDF and configuration out, calibrated from no guess.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "support/data.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kDegree = 0.017453292519943295;

const char* const kCamera =
    "image_width: 1280\nimage_height: 960\ncamera_name: camera\n"
    "camera_matrix: {rows: 3, cols: 3, data: [1000, 0, 640, 0, 1000, 480, 0, 0, 1]}\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n"
    "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
    "projection_matrix: {rows: 3, cols: 4, data: [1000, 0, 640, 0, 0, 1000, 480, 0, 0, 0, 1, 0]}\n";

/// A camera on the hand of a KUKA that looks at a board which stands still.
class HandEyeProgram : public test::ProgramTest {
 protected:
  HandEyeProgram() {
    write("camera.yaml", kCamera);
    std::string poses = "image,X,Y,Z,A,B,C\n", corners = "image,id,u,v\n", target = "id,x,y,z\n";
    const Pose<double> flange_T_camera{
        rotation_from_rpy({10 * kDegree, -5 * kDegree, 80 * kDegree}), {0.03, -0.06, 0.11}};
    const Pose<double> base_T_board{rotation_from_rpy({3 * kDegree, -2 * kDegree, 30 * kDegree}),
                                    {0.7, 0.1, 0.02}};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> side(-0.15, 0.15), tilt(-0.45, 0.45);
    std::normal_distribution<double> noise(0.0, 0.1);  // pixels
    std::vector<Vector3<double>> points;
    for (int i = 0; i < 24; ++i) {
      points.push_back({0.03 * (i % 6), 0.03 * (i / 6), 0.0});
      target += fmt::format("{},{},{},0\n", i, points.back().x(), points.back().y());
    }
    for (int n = 0; n < 20; ++n) {
      const Pose<double> camera_T_board{
          rotation_from_rpy({tilt(random), tilt(random), 3.0 * tilt(random)}),
          {side(random) - 0.07, side(random) - 0.05, 0.6 + side(random)}};
      const Pose<double> base_T_flange =
          base_T_board * camera_T_board.inverse() * flange_T_camera.inverse();
      const Vector3<double> t = 1e3 * base_T_flange.translation,
                            rpy = rpy_from_rotation(base_T_flange.rotation) / kDegree;
      poses +=
          fmt::format("{},{},{},{},{},{},{}\n", n, t.x(), t.y(), t.z(), rpy.z(), rpy.y(), rpy.x());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3<double> p = camera_T_board * points[i];
        corners += fmt::format("{},{},{},{}\n", n, i, 640 + 1000 * p.x() / p.z() + noise(random),
                               480 + 1000 * p.y() / p.z() + noise(random));
      }
    }
    write("poses.csv", poses);
    write("corners.csv", corners);
    write("target.csv", target);
  }
  [[nodiscard]] bool exists(const char* name) const {
    return std::filesystem::exists(folder_ / name);
  }
};

TEST_F(HandEyeProgram, CalibratesFromTablesWithoutAUrdfOrAGuess) {
  const test::Outcome init = kinecal(
      "init --poses poses.csv --target world_charuco --corners corners.csv --target-points "
      "target.csv");
  ASSERT_EQ(init.code, 0) << init.err;
  EXPECT_THAT(init.out, HasSubstr("20 poses of the flange"));
  const test::Outcome convert = kinecal("convert poses.csv samples.yaml --columns columns.yaml");
  ASSERT_EQ(convert.code, 0) << convert.err;
  const test::Outcome done = kinecal(
      "calibrate --urdf hand_eye.urdf --config calibrate.yaml --samples samples.yaml --camera "
      "camera=camera.yaml --output calibrated");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("verdict: good"));
  EXPECT_THAT(done.out + done.err, Not(HasSubstr(" of flange_joint")));
  const std::string matrix = read("calibrated/camera_joint.txt");
  std::istringstream in(matrix);
  std::vector<double> numbers;
  for (double number = 0.0; in >> number;) numbers.push_back(number);
  const NumberedPose found = pose_from_numbers(*pose_form("matrix"), numbers);
  EXPECT_EQ(found.wrong, "");
  EXPECT_LE((found.pose.translation - Vector3<double>(0.03, -0.06, 0.11)).norm(), 1.5e-3);
  const Matrix3<double> truth = rotation_from_rpy({10 * kDegree, -5 * kDegree, 80 * kDegree});
  EXPECT_LE((found.pose.rotation - truth).norm(), 3e-3);
  EXPECT_THAT(read("calibrated/camera_joint.sh"), HasSubstr("--frame-id flange"));
  EXPECT_EQ(kinecal("verify calibrated samples.yaml --camera camera=camera.yaml").code, 0);
}

/// The intrinsics that its authors gave are not those of this camera.
TEST_F(HandEyeProgram, TheVerdictNamesALensThatIsAtFault) {
  KINECAL_NEEDS_DATA("hand_eye_charuco")
  const std::string data = (test::data_folder() / "hand_eye_charuco").string();
  const test::Outcome done =
      kinecal("calibrate --urdf " + data + "/stage.urdf --config " + data +
              "/calibrate.yaml --samples " + data + "/samples.yaml --output out");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("verdict: use with care"),
                              HasSubstr("the lens of 'camera' is at fault")));
}

TEST_F(HandEyeProgram, RefusesWhatIsMissingAndWritesNothing) {
  const test::Outcome no_target = kinecal("init --poses poses.csv");
  EXPECT_EQ(no_target.code, 1);
  EXPECT_THAT(no_target.err, AllOf(HasSubstr("--target"), HasSubstr("world_charuco")));
  const test::Outcome neither = kinecal("init --target charuco");
  EXPECT_EQ(neither.code, 1);
  EXPECT_THAT(neither.err, AllOf(HasSubstr("--urdf"), HasSubstr("--poses")));
  write("poses.csv", "image,X,Y,Z,D,E,F\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n");
  const test::Outcome unknown = kinecal("init --poses poses.csv --target charuco");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.err, AllOf(HasSubstr("poses.csv"), HasSubstr("--form")));
  for (const char* file : {"hand_eye.urdf", "columns.yaml", "calibrate.yaml", "capture.yaml"}) {
    EXPECT_FALSE(exists(file)) << file;
  }
}

}  // namespace
}  // namespace kinecal
