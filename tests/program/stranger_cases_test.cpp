// Files of strangers that were refused or read wrong.  The inputs lie beside the data; each test says
// what is right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "kinecal/capture/boards/square_edges.hpp"
#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class StrangerCases : public test::ProgramTest {
 protected:
  /// The folder of a case; empty if the cases are not there.
  [[nodiscard]] static fs::path folder(const std::string& name) {
    const fs::path all = test::data_folder().parent_path() / "cases";
    return fs::exists(all / name) ? all / name : fs::path{};
  }
  [[nodiscard]] static std::string text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] static std::string replaced(std::string all, const std::string& from,
                                            const std::string& to) {
    for (std::size_t at = all.find(from); at != std::string::npos; at = all.find(from, at)) {
      all.replace(at, from.size(), to);
      at += to.size();
    }
    return all;
  }
  /// Copies a file of a case into the test's folder.
  void take(const fs::path& of, const std::string& file) const { write(file, text(of / file)); }
  [[nodiscard]] test::Outcome calibrate() const {
    return kinecal(
        "calibrate --urdf robot.urdf --config calibrate.yaml --samples samples.yaml --output out "
        "--force");
  }
  /// The calibrated value of a parameter.
  [[nodiscard]] double value(const std::string& parameter) const {
    const std::string all = read("out/calibration.yaml"), key = "\n" + parameter + ": ";
    const std::size_t at = ("\n" + all).find(key);
    return at == std::string::npos ? -1.0 : std::stod(("\n" + all).substr(at + key.size()));
  }
};

#define KINECAL_NEEDS_STRANGER(variable, name) \
  const fs::path variable = folder(name);      \
  if (variable.empty()) GTEST_SKIP() << "case '" << (name) << "' is not beside the data"

TEST_F(StrangerCases, LinksMayBeginWithASlashInAnyFile) {
  KINECAL_NEEDS_STRANGER(of, "02-link-names-with-leading-slash");
  const std::string urdf = text(of / "robot.urdf"), config = text(of / "calibrate.yaml"),
                    samples = text(of / "samples.yaml");
  const std::string half =
      replaced(replaced(urdf, "\"/px/l3\"", "\"px/l3\""), "\"/px/flange\"", "\"px/flange\"");
  const auto plain = [](const std::string& all) { return replaced(all, "/px/", "px/"); };
  for (const std::string& robot : {urdf, half, plain(urdf)}) {
    for (const bool slash : {true, false}) {
      write("robot.urdf", robot);
      write("calibrate.yaml", slash ? config : plain(config));
      write("samples.yaml", slash ? plain(samples) : samples);
      const test::Outcome result = calibrate();
      ASSERT_EQ(result.code, 0) << result.err;
      EXPECT_NEAR(value("j3"), 0.015, 1e-3);
      const std::string calibrated = read("out/calibrated.urdf");
      for (const char* link : {"floor", "l3", "flange"}) {
        const std::string name = std::string("px/") + link + "\"";
        EXPECT_EQ(calibrated.find("\"/" + name) == std::string::npos,
                  robot.find("\"/" + name) == std::string::npos)
            << link << " is written as it was";
      }
    }
  }
}

TEST_F(StrangerCases, ALinkMayBeJustASlash) {
  KINECAL_NEEDS_STRANGER(of, "02-link-names-with-leading-slash");
  for (const char* file : {"robot.urdf", "calibrate.yaml", "samples.yaml"}) {
    write(file, replaced(text(of / file), "/px/floor", "/"));
  }
  write("calibrate.yaml", replaced(text(of / "calibrate.yaml"), "/px/floor", "\"/\""));
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("j3"), 0.015, 1e-3);
}

TEST_F(StrangerCases, LinksThatDifferOnlyByTheSlashAreAnError) {
  KINECAL_NEEDS_STRANGER(of, "02-link-names-with-leading-slash");
  for (const char* file : {"calibrate.yaml", "samples.yaml"}) take(of, file);
  write("robot.urdf", replaced(text(of / "robot.urdf"), "/px/l4", "px/l3"));
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("robot.urdf:3: links '/px/l3' and 'px/l3' differ only by"));
}

TEST_F(StrangerCases, ACameraFileWithAKeyOfADistortionKeepsIt) {
  KINECAL_NEEDS_STRANGER(of, "06-opencv-key-dist_coeff");
  const std::string file = text(of / "camera.yaml");
  write("camera.yaml", file);
  EXPECT_THAT(kinecal("camera camera.yaml").out, HasSubstr("-0.32 0.15"));
  for (const char* key : {"distorsion_coefs", "lens_model_coeffs", "radial_tangential", "kc"}) {
    write("camera.yaml", replaced(file, "dist_coeff", key));
    const test::Outcome result = kinecal("camera camera.yaml");
    EXPECT_EQ(result.code, 1) << key;
    EXPECT_THAT(result.err, HasSubstr("unknown key '" + std::string(key) + "'"));
  }
  write("camera.yaml",
        replaced(file, "image_width: 1280\nimage_height: 720", "image_size: [1280, 720]"));
  const test::Outcome size = kinecal("camera camera.yaml");
  EXPECT_EQ(size.code, 1);
  EXPECT_THAT(size.err, HasSubstr("unknown key 'image_size' looks like the size of the image"));
}

TEST_F(StrangerCases, RawPixelsOfARationalLensAreUsed) {
  KINECAL_NEEDS_STRANGER(of, "08-raw-rational-camera");
  for (const char* file : {"robot.urdf", "calibrate.yaml", "samples.yaml"}) take(of, file);
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("taken as raw"));
  EXPECT_NEAR(value("camera_joint_y"), 0.005, 0.001);
}

TEST_F(StrangerCases, RawPixelsOfALensThatIsNotSupportedAreRefused) {
  KINECAL_NEEDS_STRANGER(of, "08-raw-rational-camera");
  for (const char* file : {"robot.urdf", "calibrate.yaml", "samples.yaml"}) take(of, file);
  ASSERT_EQ(run("sed -i s/rational_polynomial/equidistant/ samples.yaml").code, 0);
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("calibrate.yaml:4: sensor 'camera': its lens: equidistant "
                              "has 4 distortion coefficients, not 8"),
                    HasSubstr("write 'image: rectified'")));
  EXPECT_FALSE(fs::exists(folder_ / "out/calibration.yaml"));
}

TEST_F(StrangerCases, TheLedsOfRos2AreRead) {
  KINECAL_NEEDS_STRANGER(of, "09-ros2-led-finder");
  KINECAL_NEEDS_DATA("fetch");
  for (const char* file : {"capture.yaml", "poses.yaml"}) take(of, file);
  const test::Outcome result = kinecal("capture capture.yaml --robot pipe:/bin/false --urdf " +
                                       (test::data_folder() / "fetch/fetch.urdf").string() +
                                       " --poses poses.yaml -o s.yaml");
  EXPECT_NE(result.code, 0) << "the robot ends at once";
  EXPECT_THAT(result.err, Not(HasSubstr("capture.yaml:")));
}

TEST_F(StrangerCases, APriorOnWhatIsHeldIsAWarning) {
  KINECAL_NEEDS_STRANGER(of, "10-prior-on-held-frame");
  for (const char* file : {"robot.urdf", "calibrate.yaml", "samples.yaml"}) take(of, file);
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("warning: calibrate.yaml:11: error block 'restrict_mount' has "
                                    "no effect: no step frees its param 'j6'"));
  EXPECT_NEAR(value("j1"), 0.020, 1e-3);
  write("calibrate.yaml", replaced(text(of / "calibrate.yaml"), "param: j6", "param: wrist_flx"));
  EXPECT_EQ(calibrate().code, 1) << "the robot has no such joint";
}

TEST_F(StrangerCases, ACoupledJointIsNamed) {
  KINECAL_NEEDS_STRANGER(of, "18-fanuc-j3-against-the-horizontal");
  for (const char* file : {"robot.urdf", "log.csv"}) take(of, file);
  EXPECT_EQ(kinecal("init --urdf robot.urdf --from log.csv").code, 0);
  EXPECT_EQ(kinecal("convert log.csv samples.yaml --columns columns.yaml").code, 0);
  const std::string cause =
      "  - likely cause: with the positions of 'joint_3', to which those of "
      "'joint_2' are added";
  EXPECT_THAT(calibrate().out, HasSubstr("verdict: do not use\n" + cause));
  const test::Outcome search =
      kinecal("identify --urdf robot.urdf --samples samples.yaml -o i.yaml");
  EXPECT_THAT(search.out, HasSubstr(cause));
  EXPECT_THAT(search.out, Not(HasSubstr("another robot")));
}

TEST_F(StrangerCases, MarkerPosesOneRowLateAreNamed) {
  KINECAL_NEEDS_STRANGER(of, "19-marker-poses-one-row-late");
  for (const char* file : {"samples.yaml", "samples_200.yaml"}) {
    const std::string poses = (of / file).string();
    EXPECT_EQ(kinecal("init --force --poses " + poses + " --target world_marker").code, 0);
    const test::Outcome found = kinecal(
        "calibrate --urdf hand_eye.urdf --config calibrate.yaml --samples "
        "hand_eye_samples.yaml --output out");
    EXPECT_EQ(found.code, 2);
    EXPECT_THAT(found.out, testing::ContainsRegex("likely cause: with the poses of '[a-z_]+' of "
                                                  "the sample (before|after)"));
  }
}

TEST_F(StrangerCases, EveryJointThatIsReversedIsNamed) {
  KINECAL_NEEDS_STRANGER(of, "20-joints-reversed");
  const std::pair<const char*, const char*> logs[] = {{"log.csv", "'j1', 'j2', 'j3' and 'j5'"},
                                                      {"two.csv", "'j2' and 'j3'"}};
  for (const auto& [log, joints] : logs) {
    const std::string urdf = " --urdf " + (of / "arm.urdf").string();
    EXPECT_EQ(kinecal("init --force" + urdf + " --from " + (of / log).string()).code, 0);
    EXPECT_EQ(
        kinecal("convert --force " + (of / log).string() + " samples.yaml --columns columns.yaml")
            .code,
        0);
    const test::Outcome found =
        kinecal("calibrate" + urdf + " --config calibrate.yaml --samples samples.yaml --dry-run");
    EXPECT_THAT(found.out,
                HasSubstr("verdict: do not use\n  - likely cause: with the positions of " +
                          std::string(joints) + " negated, the mean residual"));
  }
}

TEST_F(StrangerCases, TagsWithAnotherBorderAreNamed) {
  KINECAL_NEEDS_STRANGER(of, "cap-04-border-no-hint");
  fs::create_directories(folder_ / "i");
  fs::copy_file(of / "EuRoC.png", folder_ / "i/EuRoC.png");
  write("p.csv", "image,q\nEuRoC.png,0\n");
  write(
      "cam.yaml",
      "image_width: 752\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [752, 0, 376, "
      "0, 752, 240, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, "
      "cols: 5, data: [0, 0, 0, 0, 0]}\n");
  write("c.yaml",
        "features:\n  tags: {type: AprilTagFinder2d, frame_id: board, columns: 6, rows: 6, size: "
        "0.088, spacing: 0.3}\n");
  const test::Outcome result =
      kinecal("detect c.yaml --images i --poses p.csv --camera cam.yaml --frame cam -o s.yaml");
  if (result.err.find("without libapriltag") != std::string::npos) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("tags with a border of 2 bits are seen: write border: 2"));
}

/// An image turned about its middle, larger so that all of it is to be seen.
[[nodiscard]] GrayImage turned_image(const GrayImage& image, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const int side = static_cast<int>(std::ceil(std::abs(c) * std::max(image.width, image.height) +
                                              std::abs(s) * std::max(image.width, image.height)));
  GrayImage turned(side, side);
  const Eigen::Vector2d middle(0.5 * (image.width - 1), 0.5 * (image.height - 1));
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      const double x = u - 0.5 * (side - 1), y = v - 0.5 * (side - 1);
      const Eigen::Vector2d from(c * x + s * y, c * y - s * x);
      turned(u, v) = static_cast<std::uint8_t>(std::lround(brightness_at(image, middle + from)));
    }
  }
  return turned;
}

TEST_F(StrangerCases, KalibrsGridInAFisheyePhotographIsFoundTurnedByAnyAngle) {
  KINECAL_NEEDS_STRANGER(of, "cap-02-kalibr-grid-recall");
  const GrayImage photograph = read_image((of / "TUM_VI.png").string());
  write("c.yaml",
        "features:\n  tags: {type: AprilTagFinder2d, frame_id: board, columns: 6, rows: 6, size: "
        "0.088, spacing: 0.3, border: 2}\n");
  for (const int degrees : {0, 30, 45, 90, 135}) {
    const GrayImage image = turned_image(photograph, degrees * std::numbers::pi / 180.0);
    const std::string side = std::to_string(image.width), half = std::to_string(image.width / 2);
    fs::create_directories(folder_ / "i");
    write("i/photograph.png", detail::png_bytes(image));
    write("p.csv", "image,q\nphotograph.png,0\n");
    write("cam.yaml", "image_width: " + side + "\nimage_height: " + side +
                          "\ncamera_matrix: {rows: 3, cols: 3, data: [" + side + ", 0, " + half +
                          ", 0, " + side + ", " + half +
                          ", 0, 0, 1]}\ndistortion_model: plumb_bob\n"
                          "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
    const test::Outcome result = kinecal(
        "detect c.yaml --images i --poses p.csv --camera cam.yaml --frame cam -o s.yaml --force");
    if (result.err.find("without libapriltag") != std::string::npos) GTEST_SKIP() << result.err;
    EXPECT_EQ(result.code, 0) << degrees << ": " << result.err;
    const std::string all = read("s.yaml");
    std::size_t corners = 0;
    for (std::size_t at = all.find("frame_id: cam"); at != std::string::npos;
         at = all.find("frame_id: cam", at + 1)) {
      ++corners;
    }
    EXPECT_GE(corners, 136u) << "of 144 at " << degrees << " degrees";
  }
}

TEST_F(StrangerCases, TheColumnsOfPhotographsNeedNoObservations) {
  KINECAL_NEEDS_STRANGER(of, "cap-08-detect-columns-wants-observations");
  fs::create_directories(folder_ / "i");
  fs::copy_file(of / "color_01.png", folder_ / "i/color_01.png");
  const std::string table = text(of / "pendant.csv");
  write("p.csv", table.substr(0, table.find('\n', table.find('\n') + 1) + 1));
  write(
      "cam.yaml",
      "image_width: 1280\nimage_height: 720\ncamera_matrix: {rows: 3, cols: 3, data: [1280, 0, "
      "640, 0, 1280, 360, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: "
      "1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
  write("c.yaml",
        "features:\n  tags: {type: AprilTagFinder2d, frame_id: board, columns: 6, rows: 6, size: "
        "0.024, spacing: 0.3}\n");
  write("columns.yaml",
        "joints:\n  unit: degrees\n  columns: {shoulder_pan_joint: Base, shoulder_lift_joint: "
        "Shoulder, elbow_joint: Elbow}\n");
  const test::Outcome result = kinecal(
      "detect c.yaml --images i --poses p.csv --columns columns.yaml --camera cam.yaml "
      "--frame cam -o s.yaml");
  if (result.err.find("without libapriltag") != std::string::npos) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.code, 0) << result.err;
}

TEST_F(StrangerCases, NamesThatDifferAreOneLine) {
  KINECAL_NEEDS_STRANGER(of, "cap-07-init-frees-tool0");
  take(of, "robot.urdf");
  write("samples.yaml",
        replaced(text(of / "samples.yaml"), "sensor_name: board", "sensor_name: arm"));
  ASSERT_EQ(kinecal("init --urdf robot.urdf --target world_checkerboard --camera-type camera2d "
                    "--camera camera_color_optical_frame --output calibrate.yaml < /dev/null")
                .code,
            0);
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("model 'board': no sample has a sensor of that name; did you "
                                    "mean 'arm'?"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

}  // namespace
}  // namespace kinecal
