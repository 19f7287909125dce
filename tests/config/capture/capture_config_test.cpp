#include "kinecal/config/capture/capture_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/data.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A file with this text.
struct CaptureFile {
  explicit CaptureFile(const std::string& text) {
    std::ofstream(path()) << text;
    config = read_capture_config(path(), diagnostics);
  }
  [[nodiscard]] std::string path() const { return (folder.path() / "capture.yaml").string(); }

  TemporaryFolder folder;
  Diagnostics diagnostics;
  CaptureConfig config;
};

TEST(CaptureConfig, ReadsThoseOfTheFetch) {
  KINECAL_NEEDS_DATA("fetch");
  Diagnostics diagnostics;
  const auto folder = data_folder() / "fetch";
  const CaptureConfig both =
      read_capture_config((folder / "capture_with_ground.yaml").string(), diagnostics);
  const CaptureConfig board =
      read_capture_config((folder / "capture_checkerboards.yaml").string(), diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
  ASSERT_EQ(both.chains.size(), 2u);
  EXPECT_EQ(both.chains[1].topic, "/head_controller/follow_joint_trajectory");
  EXPECT_THAT(both.chains[1].joints, ElementsAre("head_pan_joint", "head_tilt_joint"));
  ASSERT_EQ(both.finders.size(), 2u);
  const auto& leds = std::get<LedFinder>(both.finders[0].settings);
  EXPECT_EQ(both.finders[0].action, "/gripper_controller/led_action");
  EXPECT_EQ(leds.threshold, 500.0);
  EXPECT_EQ(leds.max_iterations, 25);
  ASSERT_EQ(leds.leds.size(), 4u);
  EXPECT_EQ(leds.leds[3].code, 8);
  EXPECT_EQ(leds.leds[3].position, Vector3<double>(0.1044, -0.0355, 0.0396));
  const auto& ground = std::get<PlaneFinder>(both.finders[1].settings);
  EXPECT_EQ(region_frame(both.finders[1].settings), "base_link");
  EXPECT_EQ(ground.region.least.z(), -2.0);
  EXPECT_EQ(std::get<CheckerboardSettings>(board.finders.at(0).settings).target.corners,
            CornerKind::points);
  EXPECT_EQ(board.finders[0].camera_info, "/head_camera/depth_registered/camera_info");
}

TEST(CaptureConfig, ReadsTheDialectOfRos2) {
  const CaptureFile file(
      "robot_calibration:\n  ros__parameters:\n    chains: [arm]\n"
      "    arm: {topic: /arm/follow_joint_trajectory, joints: [elbow, wrist]}\n"
      "    features: [board, tags, both]\n"
      "    board: {type: 'robot_calibration::CheckerboardFinder2d', topic: /camera/image_raw,\n"
      "            points_x: 7, points_y: 5, size: 0.03}\n"
      "    tags: {type: AprilTagFinder2d, topic: /camera/image_raw, columns: 6, rows: 5,\n"
      "           size: 0.04, spacing: 0.25}\n"
      "    both: {type: CharucoFinder, topic: /camera/points, squares_x: 8, dictionary: "
      "DICT_5X5_100}\n");
  EXPECT_THAT(file.diagnostics.errors, IsEmpty());
  ASSERT_EQ(file.config.finders.size(), 3u);
  EXPECT_EQ(std::get<CharucoSettings>(file.config.finders[2].settings).squares_x, 8);
  const auto& board = std::get<CheckerboardSettings>(file.config.finders[0].settings);
  EXPECT_EQ(board.points_x, 7);
  EXPECT_EQ(board.target.corners, CornerKind::pixels);
  EXPECT_EQ(std::get<AprilTagSettings>(file.config.finders[1].settings).spacing, 0.25);
  EXPECT_THAT(file.config.chains.at(0).joints, ElementsAre("elbow", "wrist"));
}

TEST(CaptureConfig, ReadsTheLedsOfRos2) {
  const CaptureFile file(
      "robot_calibration:\n  ros__parameters:\n    features: [lights]\n"
      "    lights: {type: 'robot_calibration::LedFinder', leds: [upper, lower],\n"
      "             upper: {code: 1, topic: upper_debug, x: 0.06, y: 0.02, z: 0.03},\n"
      "             lower: {code: 2, z: -0.01}}\n");
  EXPECT_THAT(file.diagnostics.errors, IsEmpty());
  EXPECT_THAT(file.diagnostics.warnings, IsEmpty());
  ASSERT_EQ(file.config.finders.size(), 1u);
  EXPECT_EQ(file.config.finders[0].topic, "/lights/points");
  const auto& leds = std::get<LedFinder>(file.config.finders[0].settings).leds;
  ASSERT_EQ(leds.size(), 2u);
  EXPECT_EQ(leds[0].code, 1);
  EXPECT_EQ(leds[0].name, "upper");
  EXPECT_EQ(leds[0].position, Vector3<double>(0.06, 0.02, 0.03));
  EXPECT_EQ(leds[1].position, Vector3<double>(0, 0, -0.01)) << "zero by default, as in ROS 2";
}

TEST(CaptureConfig, AnLedWithoutItsMapIsAnError) {
  const CaptureFile file(
      "n:\n  ros__parameters:\n    features: [f]\n"
      "    f: {type: LedFinder, leds: [upper, lower], uper: {code: 1}, lower: {code: 2}}\n");
  EXPECT_THAT(
      file.diagnostics.errors,
      ElementsAre(HasSubstr("LED 'upper' has no map 'upper' beside the list 'leds'; did you "
                            "mean 'uper'?")));
}

TEST(CaptureConfig, APluginOfImagesFindsPixels) {
  const CaptureFile file(
      "n:\n  ros__parameters:\n    features: [f]\n    f: {size: 0.02, type: "
      "'robot_calibration::CheckerboardFinder<sensor_msgs::msg::Image>'}\n");
  EXPECT_THAT(file.diagnostics.errors, IsEmpty());
  const auto& board = std::get<CheckerboardSettings>(file.config.finders.at(0).settings);
  EXPECT_EQ(board.target.corners, CornerKind::pixels);
}

TEST(CaptureConfig, OneFileMayHoldTheCalibrationAndOtherNodes) {
  const CaptureFile file(
      "other:\n  ros__parameters: {a: 1}\n"
      "fetch:\n  robot_calibration:\n    ros__parameters:\n      features: [f]\n"
      "      f: {type: CheckerboardFinder, size: 0.02}\n      base_link: base\n"
      "      calibration_steps: [once]\n      once: {free_params: [a]}\n");
  EXPECT_THAT(file.diagnostics.errors, IsEmpty());
  EXPECT_THAT(file.diagnostics.warnings, ElementsAre(HasSubstr("node 'other' is ignored")));
  EXPECT_EQ(file.config.finders.size(), 1u);
}

TEST(CaptureConfig, EveryKeyOfTheTagFinderIsRead) {
  const CaptureFile file(
      "features:\n  f: {type: AprilTagFinder2d, columns: 2, rows: 1, size: 0.1, border: 2, "
      "first_id: "
      "7,\n      family: tag25h9, min_tags: 2, decimate: 1, min_side: 12, max_wrong_bits: 0,\n"
      "      min_square: 5, max_glare: 0.1, max_bleed: 2, max_edge_width: 9}\n");
  EXPECT_THAT(file.diagnostics.errors, IsEmpty());
  EXPECT_THAT(file.diagnostics.warnings, IsEmpty());
  EXPECT_THAT(file.diagnostics.notes, ElementsAre(HasSubstr("spacing is not given: gaps of 0.3")));
  const auto& tags = std::get<AprilTagSettings>(file.config.finders.at(0).settings);
  EXPECT_EQ(tags.border, 2);
  EXPECT_EQ(tags.decimate, 1.0);
  EXPECT_EQ(tags.min_side, 12.0);
  EXPECT_EQ(tags.max_wrong_bits, 0);
  EXPECT_EQ(tags.target.quality.max_bleed, 2.0);
}

TEST(CaptureConfig, MarkersOfArucoAreTagsOfADictionary) {
  const CaptureFile file(
      "features:\n  f: {type: ArucoFinder6d, dictionary: DICT_5X5_100, tags: [{id: 7, size: "
      "0.08}]}\n");
  EXPECT_THAT(file.diagnostics.errors, IsEmpty());
  EXPECT_THAT(file.diagnostics.warnings, IsEmpty());
  const auto& tags = std::get<AprilTagSettings>(file.config.finders.at(0).settings);
  EXPECT_EQ(tags.family, "DICT_5X5_100");
  EXPECT_EQ(tags.target.corners, CornerKind::pose);
  ASSERT_EQ(tags.tags.size(), 1u);
  EXPECT_EQ(tags.tags[0].id, 7);
  EXPECT_EQ(tags.tags[0].size, 0.08);
  const CaptureFile wrong("features:\n  f: {type: ArucoFinder2d, family: tag36h11, size: 0.1}\n");
  EXPECT_THAT(wrong.diagnostics.warnings, ElementsAre(HasSubstr("unknown key 'family'")));
}

TEST(CaptureConfig, GridsOfDiscsAreRead) {
  const CaptureFile file(
      "features:\n  f: {type: CircleGridFinder2d, points_x: 7, points_y: 5, size: 0.03, pattern: "
      "symmetric}\n  g: {type: CircleGridFinder, size: 0.02, pattern: round}\n");
  EXPECT_THAT(file.diagnostics.warnings, IsEmpty());
  EXPECT_THAT(file.diagnostics.errors, ElementsAre(HasSubstr("pattern")));
  const auto& grid = std::get<CircleGridSettings>(file.config.finders.at(0).settings);
  EXPECT_EQ(grid.points_x, 7);
  EXPECT_EQ(grid.points_y, 5);
  EXPECT_EQ(grid.size, 0.03);
  EXPECT_FALSE(grid.asymmetric);
  EXPECT_EQ(grid.target.corners, CornerKind::pixels);
}

TEST(CaptureConfig, ADefaultSizeIsNoted) {
  const CaptureFile board("features:\n  f: {type: CheckerboardFinder}\n");
  EXPECT_THAT(board.diagnostics.notes,
              ElementsAre(HasSubstr("finder 'f': size is not given: squares of 24.5 mm")));
  const CaptureFile charuco("features:\n  f: {type: CharucoFinder, square_size: 0.03}\n");
  EXPECT_THAT(charuco.diagnostics.notes,
              ElementsAre(HasSubstr("marker_size is not given: markers of 30.0 mm")));
}

TEST(CaptureConfig, AKeyThatLooksLikeASizeIsAnErrorIfItIsUnknown) {
  const auto error_of = [](const std::string& type, const std::string& key) {
    const CaptureFile file("features:\n  f: {type: " + type + ", columns: 2, rows: 2, " + key +
                           ": 0.03}\n");
    for (const std::string& error : file.diagnostics.errors) {
      if (error.find("'" + key + "'") != std::string::npos) return error;
    }
    return std::string("none");
  };
  for (const char* key : {"square_size", "squareSize", "square_length", "side", "tile_width"}) {
    EXPECT_THAT(error_of("CheckerboardFinder", key), HasSubstr("did you mean 'size'?")) << key;
  }
  for (const char* key : {"tagSize", "tag_size", "edge_length"}) {
    EXPECT_THAT(error_of("AprilTagFinder", key), HasSubstr("did you mean 'size'?")) << key;
  }
  EXPECT_THAT(error_of("AprilTagFinder", "tagSpacing"), HasSubstr("did you mean 'spacing'?"));
  EXPECT_THAT(error_of("AprilTagFinder", "gap"), HasSubstr("did you mean 'spacing'?"));
  EXPECT_THAT(error_of("CheckerboardFinder", "unit"), HasSubstr("looks like a unit"));
  EXPECT_EQ(error_of("CheckerboardFinder", "queue_size"), "none") << "of a program";
  EXPECT_EQ(error_of("CheckerboardFinder", "colour"), "none");
}

/// The first error of a finder with this text.
std::string first_error(const std::string& finder) {
  const CaptureFile file("features:\n  led_finder:\n" + finder);
  return file.diagnostics.errors.empty() ? "no error" : file.diagnostics.errors.front();
}

TEST(CaptureConfig, ErrorsNameTheLineAndWhatWasProbablyMeant) {
  EXPECT_THAT(first_error("    type: robot_calibration/LedFindr\n"),
              HasSubstr("capture.yaml:3: finder 'led_finder': type 'robot_calibration/LedFindr' is "
                        "not a finder; did you mean 'LedFinder'?"));
  EXPECT_THAT(first_error("    type: LedFinder\n"),
              HasSubstr("has no LEDs: list them under poses (ROS 1) or leds"));
  EXPECT_THAT(first_error("    type: LedFinder\n    poses:\n    - {code: 1, x: 0.1, y: 0.2}\n"),
              HasSubstr("LED 1: z is missing"));
  EXPECT_THAT(first_error("    type: CheckerboardFinder\n    points_x: 0\n"),
              HasSubstr("points_x"));
  EXPECT_THAT(first_error("    type: CheckerboardFinder\n    pionts_x: 5\n"),
              HasSubstr("unknown key 'pionts_x'; did you mean 'points_x'?"));
  EXPECT_THAT(first_error("    type: ScanFinder\n    z_repeats: 1000000\n"),
              HasSubstr("capture.yaml:4: finder 'led_finder': z_repeats: 1000000 copies of a scan; "
                        "the most are 1000"));
  EXPECT_THAT(first_error("    topic: /points\n"), HasSubstr("type is missing"));
  EXPECT_THAT(CaptureFile("chains: []\n").diagnostics.errors,
              ElementsAre(HasSubstr("features has no finders")));
  EXPECT_THAT(CaptureFile("- 1\n").diagnostics.errors, ElementsAre(HasSubstr("not a map")));
}

TEST(CaptureConfig, PutsRegionsOnTheRobot) {
  const Robot robot = parse_urdf(
      "<robot name='r'><link name='base'/><link name='eye'/><joint name='pan' type='revolute'>"
      "<parent link='base'/><child link='eye'/><origin xyz='0 0 1'/><axis xyz='0 0 1'/>"
      "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>",
      "r.urdf");
  CaptureFile file("features:\n  ground:\n    {type: PlaneFinder, transform_frame: base}\n");
  const FinderSettings settings = on_robot(file.config.finders.at(0), robot);
  const PoseOfView& base_T_camera = std::get<PlaneFinder>(settings).region.frame_T_camera;
  View view;
  view.frame = "eye";
  EXPECT_FALSE(base_T_camera(view).has_value());  // the position of the joint is missing
  view.joints = {{}, {"pan"}, {0.5}};
  EXPECT_EQ(base_T_camera(view)->translation, Vector3<double>(0, 0, 1));
  std::get<PlaneFinder>(file.config.finders[0].settings).region.frame = "bse";
  EXPECT_THROW((void)on_robot(file.config.finders[0], robot), InputError);
}

}  // namespace
}  // namespace kinecal::test
