// What strangers' captures showed: joints that init left out, boards whose corners were wrong, and
// sessions that ended too early or too late.  The inputs lie beside the data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

#include "support/data.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class CaptureCases : public test::ProgramTest {
 protected:
  /// The folder of a case; empty if the cases are not there.
  [[nodiscard]] static fs::path folder(const std::string& name) {
    const fs::path all = test::data_folder().parent_path() / "cases";
    return fs::exists(all / name) ? all / name : fs::path{};
  }

  /// Detects AprilTags in one photograph.
  /// @param finder  keys of the target
  [[nodiscard]] test::Outcome detect(const fs::path& photograph, int width, int height,
                                     const std::string& finder) const {
    fs::create_directories(folder_ / "images");
    for (const auto& old : fs::directory_iterator(folder_ / "images")) fs::remove(old);
    fs::copy_file(photograph, folder_ / "images" / photograph.filename());
    write("poses.csv", "image,q\n" + photograph.filename().string() + ",0\n");
    const std::string w = std::to_string(width), h = std::to_string(height);
    write("camera.yaml", "image_width: " + w + "\nimage_height: " + h +
                             "\ncamera_name: c\ncamera_matrix: {rows: 3, cols: 3, data: [" + w +
                             ", 0, " + std::to_string(width / 2) + ", 0, " + w + ", " +
                             std::to_string(height / 2) +
                             ", 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: "
                             "{rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
    write("capture.yaml",
          "features:\n  tags: {type: robot_calibration/AprilTagFinder2d, camera_sensor_name: "
          "camera, chain_sensor_name: arm, frame_id: board, " +
              finder + "}\n");
    return kinecal(
        "detect capture.yaml --images images --poses poses.csv --camera camera.yaml --frame cam "
        "--output samples.yaml --force");
  }
  /// Pixels of the camera's features, by id.
  [[nodiscard]] std::map<int, std::pair<double, double>> pixels() const {
    std::map<int, std::pair<double, double>> all;
    const YAML::Node sample = YAML::LoadAll(read("samples.yaml")).front();
    for (const YAML::Node& observation : sample["observations"]) {
      if (observation["sensor_name"].as<std::string>() != "camera") continue;
      for (const YAML::Node& feature : observation["features"]) {
        all[feature["id"].as<int>()] = {feature["point"]["x"].as<double>(),
                                        feature["point"]["y"].as<double>()};
      }
    }
    return all;
  }
};

#define KINECAL_NEEDS_CAPTURE_CASE(variable, name) \
  const fs::path variable = folder(name);          \
  if (variable.empty()) GTEST_SKIP() << "case '" << (name) << "' is not beside the data"

TEST_F(CaptureCases, InitFreesTheFirstTurnAfterARail) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "01-init-leaves-out-rail-joint");
  const std::string urdf = " --urdf " + (of / "robot.urdf").string();
  ASSERT_EQ(kinecal("init" + urdf + " --target tracker --arm flange --output c.yaml").code, 0);
  const test::Outcome done = kinecal("calibrate" + urdf + " --config c.yaml --samples " +
                                     (of / "samples.yaml").string() + " --output out");
  EXPECT_EQ(done.code, 0) << done.out;
  const YAML::Node found = YAML::LoadFile((folder_ / "out/calibration.yaml").string());
  EXPECT_NEAR(found["j1"].as<double>(), 0.02, 5e-4);
}

TEST_F(CaptureCases, CornersOfKalibrsGridAreRightOrLeftOut) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "cap-03-kalibr-grid-wrong-corners");
  for (const std::string name : {"color_01", "color_18"}) {
    const test::Outcome found = detect(of / (name + ".png"), 1280, 720,
                                       "columns: 6, rows: 6, size: 0.024, spacing: 0.3, border: 2");
    ASSERT_EQ(found.code, 0) << found.err;
    std::istringstream truth(read(of / ("truth_" + name + ".csv")));
    std::map<int, std::pair<double, double>> right;
    std::string line;
    std::getline(truth, line);
    while (std::getline(truth, line)) {
      int id = 0;
      double x = 0.0, y = 0.0;
      if (std::sscanf(line.c_str(), "%d,%lf,%lf", &id, &x, &y) == 3) right[id] = {x, y};
    }
    EXPECT_GE(pixels().size(), 4 * 34u) << "of 36 tags";
    for (const auto& [id, at] : pixels()) {
      EXPECT_LT(std::hypot(at.first - right.at(id).first, at.second - right.at(id).second), 1.0)
          << name << ", corner " << id;
    }
  }
}

TEST_F(CaptureCases, NearlyAllTagsOfKalibrsGridAreFoundThroughAFisheye) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "cap-02-kalibr-grid-recall");
  const test::Outcome found = detect(of / "TUM_VI.png", 1024, 1024,
                                     "columns: 6, rows: 6, size: 0.088, spacing: 0.3, border: 2");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_GE(pixels().size(), 4 * 34u) << "of 36 tags";
}

TEST_F(CaptureCases, TagsOfKalibrsGridAreFoundTurnedInTheImage) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "12-kalibr-aprilgrid");
  std::map<std::string, std::map<std::pair<int, int>, std::pair<double, double>>> right;
  std::istringstream truth(read(of / "truth.csv"));
  std::string line;
  std::getline(truth, line);
  while (std::getline(truth, line)) {
    int column = 0, row = 0;
    double u = 0.0, v = 0.0;
    const std::size_t comma = line.find(',');
    if (std::sscanf(line.c_str() + comma, ",%d,%d,%lf,%lf", &column, &row, &u, &v) == 4)
      right[line.substr(0, comma)][{column, row}] = {u, v};
  }
  ASSERT_EQ(right.size(), 3u);
  for (const auto& [image, corners] : right) {
    const test::Outcome found = detect(of / "images" / image, 960, 720,
                                       "columns: 6, rows: 6, size: 0.03, spacing: 0.3, border: 2");
    ASSERT_EQ(found.code, 0) << found.err;
    const auto seen = pixels();
    EXPECT_GE(seen.size(), 4 * 35u) << image;
    for (const auto& [place, at] : corners) {
      const auto corner = seen.find(4 * (6 * place.second + place.first));
      if (corner == seen.end()) continue;
      EXPECT_LT(std::hypot(corner->second.first - at.first, corner->second.second - at.second), 0.5)
          << image << ", column " << place.first << ", row " << place.second;
    }
  }
}

TEST_F(CaptureCases, TagsThatOpenCvDrewAreTakenAsTheyAreTurned) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "cap-06-tags-drawn-by-opencv");
  const fs::path board = of / "opencv_board.png";
  const test::Outcome found =
      detect(board, 1280, 720, "columns: 4, rows: 3, size: 0.04, spacing: 0.25");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.err + found.out, HasSubstr("the tags are turned by 180 degrees against the "
                                               "grid, as OpenCV draws them: taken so"));
  EXPECT_EQ(pixels().size(), 48u);
  EXPECT_NEAR(pixels().at(0).first, 443.0, 2.0) << "the bottom left corner of the board";
  EXPECT_NEAR(pixels().at(0).second, 485.0, 2.0);
  EXPECT_NEAR(pixels().at(46).first, 864.0, 2.0) << "the top right corner";
  const test::Outcome columns =
      detect(board, 1280, 720, "columns: 3, rows: 4, size: 0.04, spacing: 0.25");
  EXPECT_EQ(columns.code, 1);
  EXPECT_THAT(columns.err, HasSubstr("the tags lie in 4 columns, not in 3: write columns: 4"));
}

TEST_F(CaptureCases, ASessionDoesNotEndBeforeItsParametersAreDetermined) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "cap-01-until-ends-after-3-poses");
  const std::string urdf = (of / "mobile_manipulator.urdf").string();
  ASSERT_EQ(kinecal("simulate " + urdf + " --target apriltag --poses 30 --seed 4 -o sim").code, 0);
  const test::Outcome done = kinecal(
      "capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml --robot "
      "simulated:sim/scene.yaml -o s.bag --calibrate sim/calibrate.yaml --until \"gripper 2 mm\" "
      "--result cal");
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  std::smatch count;
  ASSERT_TRUE(std::regex_search(done.out, count, std::regex("s.bag: ([0-9]+) samples")))
      << done.out;
  EXPECT_GE(std::stoi(count[1]), 7) << "28 parameters, six numbers a pose, and half as many again";
  ASSERT_EQ(kinecal("detect sim/capture.yaml --images sim/images --poses sim/poses.csv --camera "
                    "sim/camera.yaml --frame head_camera_rgb_optical_frame -o all.yaml")
                .code,
            0);
  const test::Outcome judged = kinecal("evaluate cal all.yaml");
  std::smatch numbers;
  const std::regex row("hand_eye +[0-9]+ +px +([0-9.]+)");
  ASSERT_TRUE(std::regex_search(judged.out, numbers, row)) << judged.out;
  EXPECT_LT(std::stod(numbers[1]), 0.5) << "pixels, on all 30 photographs";
}

TEST_F(CaptureCases, ARobotIsNotDrivenOnWithoutHope) {
  KINECAL_NEEDS_CAPTURE_CASE(of, "cap-09-drives-on-without-hope");
  const std::string urdf =
      (of.parent_path() / "cap-01-until-ends-after-3-poses/mobile_manipulator.urdf").string();
  write("ok.yaml", "seed: 6\ntarget: {type: leds}\n");
  ASSERT_EQ(kinecal("simulate " + urdf + " --scene ok.yaml --poses 12 -o sim --force").code, 0);
  struct Fault {
    std::string scene, says;
    int poses;  ///< to which the robot is sent
  };
  for (const Fault& fault : {Fault{"other_clock: 100", "ahead of those of the joints", 0},
                             Fault{"no_camera_info: true", "sent no camera_info", 0},
                             Fault{"stuck_joint: elbow_flex_joint", "did not arrive", 3}}) {
    write("faulty.yaml", "seed: 6\ntarget: {type: leds}\nfaults: {" + fault.scene + "}\n");
    const test::Outcome done = kinecal(
        "capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml --robot "
        "simulated:faulty.yaml -o s.yaml --force");
    EXPECT_EQ(done.code, 1) << fault.scene;
    EXPECT_THAT(done.err, AllOf(HasSubstr("error: "), HasSubstr(fault.says))) << done.out;
    int poses = 0;
    std::istringstream lines(done.out);
    for (std::string line; std::getline(lines, line);) poses += line.starts_with("pose") ? 1 : 0;
    EXPECT_EQ(poses, fault.poses) << done.out;
  }
}

}  // namespace
}  // namespace kinecal
