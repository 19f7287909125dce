// kinecal detect as its users meet it: photographs and a table become samples that calibrate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::HasSubstr;

class Detect : public test::ProgramTest {
 protected:
  Detect() {
    fs::copy(fs::path(test::source_folder()) / "examples/robots/panda/panda.urdf", folder_);
    photograph(3);
    const std::string config = read("photos/calibrate.yaml");
    const std::size_t camera = config.find("name: camera\n");
    const std::size_t frame = config.find("frame: ", camera) + 7;
    frame_ = config.substr(frame, config.find('\n', frame) - frame);
  }
  void photograph(int poses) {
    const Outcome made = kinecal(
        "simulate panda.urdf --target apriltag --force -o photos --poses " + std::to_string(poses));
    EXPECT_EQ(made.code, 0) << made.err;
  }
  [[nodiscard]] Outcome detect(const std::string& more = "") const {
    return kinecal(
        "detect photos/capture.yaml --images photos/images --poses photos/poses.csv "
        "--camera photos/camera.yaml --frame " +
        frame_ + " -o samples.yaml " + more);
  }

  std::string frame_;  ///< of the camera
};

#if defined(KINECAL_HAVE_PNG) && defined(KINECAL_HAVE_APRILTAG)
TEST_F(Detect, PhotographsCalibrateWithoutAnInitialGuess) {
  photograph(12);
  const Outcome found = detect("--contact-sheet sheet.html");
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("wrote samples.yaml: "));
  EXPECT_THAT(read("sheet.html"), HasSubstr("12  0012.png  "));
  const Outcome checked = kinecal(
      "check --urdf photos/robot.urdf --config photos/calibrate.yaml --samples samples.yaml");
  EXPECT_EQ(checked.code, 0) << checked.err;
}

TEST_F(Detect, ADamagedImageIsNamedAndTheOthersAreUsed) {
  write("photos/images/0002.png", read("photos/images/0002.png").substr(0, 3000));
  const Outcome found = detect("--contact-sheet sheet.html");
  EXPECT_EQ(found.code, 0);
  EXPECT_THAT(found.err, HasSubstr("warning: photos/images/0002.png: the PNG is damaged"));
  EXPECT_THAT(found.out, HasSubstr("2 of 3 images"));
  EXPECT_THAT(found.out, HasSubstr("; 1 refused"));
}

TEST_F(Detect, IfAllImagesAreDamagedNothingIsWritten) {
  for (const auto& image : fs::directory_iterator(folder_ / "photos/images")) {
    write(image.path().lexically_relative(folder_).string(), "GIF");
  }
  const Outcome failed = detect();
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("nothing was found in 3 images"));
  EXPECT_FALSE(fs::exists(folder_ / "samples.yaml"));
}

TEST_F(Detect, WhereNothingIsFoundThereAreNoSamples) {
  std::string config = read("photos/capture.yaml");
  config += "    family: tag16h5\n";
  write("photos/capture.yaml", config);
  const Outcome failed = detect("--contact-sheet sheet.html");
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("nothing was found in "));
  EXPECT_FALSE(fs::exists(folder_ / "samples.yaml"));
  EXPECT_TRUE(fs::exists(folder_ / "sheet.html"));
}
#endif

TEST_F(Detect, ABoardThatLooksTheSameWhenTurnedIsAWarning) {
  const std::string board =
      "type: robot_calibration/CheckerboardFinder2d\n    points_x: 6\n    points_y: ";
  write("photos/capture.yaml", "features:\n  board:\n    " + board + "4\n");
  EXPECT_THAT(detect().err, HasSubstr("a board of 6x4 corners looks the same when it is turned"));
  write("photos/capture.yaml", "features:\n  board:\n    " + board + "5\n");
  EXPECT_THAT(detect().err, testing::Not(HasSubstr("looks the same")));
  const std::string discs = "type: CircleGridFinder2d\n    points_x: 4\n    points_y: ";
  write("photos/capture.yaml", "features:\n  discs:\n    " + discs + "10\n");
  EXPECT_THAT(detect().err, HasSubstr("a grid of 4x10 discs looks the same when it is turned"));
  write("photos/capture.yaml", "features:\n  discs:\n    " + discs + "11\n");
  EXPECT_THAT(detect().err, testing::Not(HasSubstr("looks the same")));
}

TEST_F(Detect, ATableWithFewerRowsThanImagesNamesTheImages) {
  write("photos/poses.csv", read("photos/poses.csv").substr(0, 200));
  std::string table = read("photos/poses.csv");
  write("photos/poses.csv", table.substr(0, table.rfind('\n') + 1));
  const Outcome failed = detect();
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("has no row for image 0003.png"));
}

TEST_F(Detect, ColumnsThatAreNotJointsOfTheRobotAreNamed) {
  std::string table = read("photos/poses.csv");
  const std::size_t joint = table.find("panda_joint3");
  ASSERT_NE(joint, std::string::npos);
  write("photos/poses.csv", table.replace(joint, 12, "panda_jiont3"));
  const Outcome failed = detect("--urdf panda.urdf");
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("photos/poses.csv:1: column 'panda_jiont3' is not a joint of "
                                    "panda.urdf; did you mean 'panda_joint3'?"));
  EXPECT_FALSE(fs::exists(folder_ / "samples.yaml"));
}

}  // namespace
}  // namespace kinecal
