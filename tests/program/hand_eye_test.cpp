// kinecal init --poses, as users call it: tables in, URDF and configuration out, calibrated from no guess.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>
#include <random>
#include <sstream>

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

// ---- several cameras

/// Three cameras around a KUKA that holds a board: each sees a third of the poses, and one of them alone.
class CellProgram : public test::ProgramTest {
 protected:
  CellProgram() {
    std::string poses = "image,X,Y,Z,A,B,C\n", target = "id,x,y,z\n";
    std::map<std::string, std::string> corners;
    for (const auto& [name, pose] : kTruth) {
      corners[name] = "image,id,u,v\n";
      write(name + ".yaml", kCamera);
    }
    const Pose<double> flange_T_board{rotation_from_rpy({0.2, -0.1, 0.5}), {0.02, -0.05, 0.12}};
    std::mt19937 random(11);
    std::uniform_real_distribution<double> side(-0.15, 0.15), tilt(-0.45, 0.45);
    std::normal_distribution<double> noise(0.0, 0.1);  // pixels
    std::vector<Vector3<double>> points;
    for (int i = 0; i < 24; ++i) {
      points.push_back({0.03 * (i % 6), 0.03 * (i / 6), 0.0});
      target += fmt::format("{},{},{},0\n", i, points.back().x(), points.back().y());
    }
    for (int n = 0; n < 36; ++n) {
      const auto& [name, base_T_camera] = kTruth[static_cast<std::size_t>(n % 3)];
      const Pose<double> camera_T_board{
          rotation_from_rpy({tilt(random), tilt(random), 3.0 * tilt(random)}),
          {side(random) - 0.07, side(random) - 0.05, 0.9 + side(random)}};
      const Pose<double> base_T_flange = base_T_camera * camera_T_board * flange_T_board.inverse();
      const Vector3<double> t = 1e3 * base_T_flange.translation,
                            rpy = rpy_from_rotation(base_T_flange.rotation) / kDegree;
      poses +=
          fmt::format("{},{},{},{},{},{},{}\n", n, t.x(), t.y(), t.z(), rpy.z(), rpy.y(), rpy.x());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3<double> p = camera_T_board * points[i];
        corners[name] +=
            fmt::format("{},{},{},{}\n", n, i, 640 + 1000 * p.x() / p.z() + noise(random),
                        480 + 1000 * p.y() / p.z() + noise(random));
      }
    }
    write("poses.csv", poses);
    write("target.csv", target);
    for (const auto& [name, text] : corners) write(name + ".csv", text);
  }
  test::Outcome init(const std::string& cameras, const std::string& corners) {
    return kinecal(
        "init --poses poses.csv --target charuco --force --target-points target.csv --camera " +
        cameras + " --corners " + corners);
  }

  const std::vector<std::pair<std::string, Pose<double>>> kTruth = {
      {"left", {rotation_from_rpy({-1.7, 0.1, -0.4}), {-0.3, -1.2, 0.8}}},
      {"right", {rotation_from_rpy({-1.9, -0.1, 2.6}), {0.5, 1.3, 0.9}}},
      {"top", {rotation_from_rpy({3.1, 0.1, 0.7}), {0.6, 0.0, 1.9}}}};
};

TEST_F(CellProgram, CalibratesAllCamerasAndTheBoardInOneSolve) {
  const test::Outcome made = init("left,right,top", "left=left.csv,right=right.csv,top=top.csv");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("--camera left=left.yaml"));
  ASSERT_EQ(kinecal("convert poses.csv samples.yaml --columns columns.yaml").code, 0);
  const test::Outcome done = kinecal(
      "calibrate --urdf hand_eye.urdf --config calibrate.yaml --samples samples.yaml --camera "
      "left=left.yaml --camera right=right.yaml --camera top=top.yaml --between left,right,top "
      "--report report.json --report report.html --output calibrated");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out,
              AllOf(HasSubstr("verdict: good"), HasSubstr("Pose of 'right' in 'left': +- "),
                    HasSubstr("Pose of 'top' in 'right': +- ")));
  for (const auto& [name, truth] : kTruth) {
    std::istringstream in(read(("calibrated/" + name + "_joint.txt").c_str()));
    std::vector<double> numbers;
    for (double number = 0.0; in >> number;) numbers.push_back(number);
    const NumberedPose found = pose_from_numbers(*pose_form("matrix"), numbers);
    ASSERT_EQ(found.wrong, "") << name;
    EXPECT_LE((found.pose.translation - truth.translation).norm(), 2e-3) << name;
    EXPECT_LE((found.pose.rotation - truth.rotation).norm(), 3e-3) << name;
    EXPECT_THAT(read("report.html"), HasSubstr("\"cameras\":")) << "in the 3-D view";
    EXPECT_THAT(read("report.html"), HasSubstr("<title>" + name + ", sample ")) << "in the chart";
    EXPECT_THAT(read("report.html"), HasSubstr("\"name\":\"" + name + "\",\"link\":")) << name;
  }
  const YAML::Node report = YAML::Load(read("report.json"));
  ASSERT_EQ(report["between"].size(), 3u);
  EXPECT_EQ(report["between"][0]["frame"].as<std::string>(), "right");
  EXPECT_EQ(report["between"][0]["in"].as<std::string>(), "left");
  EXPECT_GT(report["between"][0]["position"].as<double>(), 1e-5);
  EXPECT_LT(report["between"][0]["position"].as<double>(), 2e-3);
  const test::Outcome unknown = kinecal(
      "calibrate --urdf hand_eye.urdf --config calibrate.yaml --samples samples.yaml --camera "
      "left=left.yaml --camera right=right.yaml --camera top=top.yaml --between left,rihgt "
      "--output "
      "other");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.err,
              AllOf(HasSubstr("--between: 'rihgt'"), HasSubstr("did you mean 'right'")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other"));
}

TEST_F(CellProgram, ACameraInNoSampleIsAReasonOfTheVerdict) {
  ASSERT_EQ(init("left,right,top", "left=left.csv,right=right.csv,top=top.csv").code, 0);
  for (const char* file : {"hand_eye.urdf", "calibrate.yaml"}) {
    std::filesystem::rename(folder_ / file, folder_ / (std::string("cell_") + file));
  }
  ASSERT_EQ(init("left,right", "left=left.csv,right=right.csv").code, 0);
  ASSERT_EQ(kinecal("convert poses.csv samples.yaml --columns columns.yaml").code, 0);
  const test::Outcome done = kinecal(
      "calibrate --urdf cell_hand_eye.urdf --config cell_calibrate.yaml --samples samples.yaml "
      "--camera left=left.yaml --camera right=right.yaml --output calibrated");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("verdict: use with care"),
                              HasSubstr("model 'top': no sample has a sensor of that name"),
                              HasSubstr("keep their initial values")));
}

TEST_F(CellProgram, NamesWhatIsWrongWithCamerasAndTablesInASentence) {
  const std::string all = "left=left.csv,right=right.csv,top=top.csv";
  const auto refusal = [&](const std::string& cameras, const std::string& corners) {
    const test::Outcome made = init(cameras, corners);
    EXPECT_EQ(made.code, 1) << made.out;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "calibrate.yaml"));
    return made.err;
  };
  EXPECT_THAT(refusal("left,left", "left=left.csv"), HasSubstr("--camera: 'left' occurs twice"));
  EXPECT_THAT(refusal("left,arm", all), HasSubstr("'arm' cannot be the name of a camera"));
  EXPECT_THAT(refusal("left,right,top", "left=left.csv,right=right.csv"),
              HasSubstr("--corners: camera 'top' sees nothing: add top=FILE"));
  EXPECT_THAT(refusal("left,right", all), HasSubstr("--corners: no camera 'top'"));
  EXPECT_THAT(refusal("left,right", "left.csv"), HasSubstr("'left.csv' is no NAME=FILE"));
  write("none.csv", "image,id,u,v\n");
  EXPECT_THAT(refusal("left,right", "left=left.csv,right=none.csv"), HasSubstr("none.csv"));
  write("others.csv", "image,id,u,v\nx,0,1,2\nx,1,1,3\n");
  EXPECT_THAT(refusal("left,right", "left=left.csv,right=others.csv"),
              AllOf(HasSubstr("others.csv: camera 'right' sees nothing"), HasSubstr("(x, ...)")));
}

}  // namespace
}  // namespace kinecal
