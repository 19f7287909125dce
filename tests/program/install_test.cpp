// Installing a result as users do: what the program says, its exit codes, the robot's folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/launch_scene.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class InstallProgram : public test::InstallScene {
 protected:
  [[nodiscard]] test::Outcome run(const std::string& arguments) const {
    return test::run_in(folder_, test::kinecal_program() + " install " + arguments);
  }
  void expect_refused(const std::string& arguments, const testing::Matcher<std::string>& message,
                      int code = 1) const {
    const auto before = robot();
    const test::Outcome result = run(arguments);
    EXPECT_EQ(result.code, code) << result.out;
    EXPECT_THAT(result.err, message);
    EXPECT_EQ(robot(), before);
  }
};

TEST_F(InstallProgram, InstallsRestoresAndPrintsTheDate) {
  EXPECT_EQ(run("--to robot --date").out, "uncalibrated\n");
  const test::Outcome installed = run("out --to robot");
  EXPECT_EQ(installed.code, 0) << installed.err;
  EXPECT_THAT(installed.out, AllOf(HasSubstr("wrote robot/calibrated_2026_01_02_03_04_05.urdf\n"),
                                   HasSubstr("changed robot/robot.launch; the previous version is "
                                             "robot.launch.backup_1, --restore puts it back\n")));
  EXPECT_THAT(launch(), HasSubstr("textfile=\"" + folder_.string() + "/robot/calibrated_2026"));
  EXPECT_EQ(run("--date --to robot").out, "2026-01-02 03:04:05\n");
  const test::Outcome again = run("out --to robot/");
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.out, HasSubstr("is unchanged: this calibration is already installed"));
  const test::Outcome restored = run("--restore --to robot");
  EXPECT_EQ(restored.code, 0) << restored.err;
  EXPECT_THAT(restored.out, StartsWith("restored robot/robot.launch; "));
  EXPECT_EQ(launch(), test::kLaunch);
  expect_refused("--restore --to robot", HasSubstr("nothing to restore"));
}

TEST_F(InstallProgram, ResetsToTheFactorysAndBack) {
  write("factory.launch", test::kLaunch);
  EXPECT_EQ(run("out --to robot").code, 0);
  const std::string calibrated = launch();
  const test::Outcome reset = run("--reset factory.launch --to robot");
  EXPECT_EQ(reset.code, 0) << reset.err;
  EXPECT_THAT(reset.out, HasSubstr("is that of factory.launch; the previous version is "
                                   "robot.launch.backup_2, --restore puts it back"));
  EXPECT_EQ(launch(), test::kLaunch);
  EXPECT_THAT(run("--reset factory.launch --to robot").out, HasSubstr("is unchanged"));
  EXPECT_EQ(run("--restore --to robot").code, 0);
  EXPECT_EQ(launch(), calibrated);
  write("factory.launch", "<robot/>");
  expect_refused("--reset factory.launch --to robot", HasSubstr("factory.launch:1: the root"));
  expect_refused("--reset none.launch --to robot", HasSubstr("none.launch: cannot be read"));
}

TEST_F(InstallProgram, TheLaunchFileAndItsNamesMayBeOthers) {
  fs::rename(folder_ / "robot/robot.launch", folder_ / "robot/arm.launch");
  spoil("robot/arm.launch", "calibration_date\" value='un", "calibrated_on\" value='un");
  expect_refused("out --to robot", AllOf(HasSubstr("error: robot/robot.launch: is not there")));
  expect_refused("out --to robot --launch arm.launch",
                 AllOf(HasSubstr("robot/arm.launch: no param 'calibration_date'"),
                       HasSubstr("--name calibration_date=NAME names another one")));
  expect_refused("out --to robot --launch arm.launch --name calibration_dat=x",
                 HasSubstr("did you mean 'calibration_date'?"));
  const std::string names =
      " --launch arm.launch --name calibration_date=calibrated_on --name z_scaling= ";
  EXPECT_EQ(run("out --to robot" + names).code, 0);
  EXPECT_THAT(read("robot/arm.launch"), HasSubstr("z_scaling\" value=\"1.0\""));
  EXPECT_EQ(run("--date --to robot" + names).out, "2026-01-02 03:04:05\n");
}

TEST_F(InstallProgram, RefusesWhatShouldNotBeUsed) {
  write("out/report.json",
        R"({"verdict": "do not use", "reasons": ["sigma 1 mm given"], "converged": true})");
  expect_refused("out --to robot", HasSubstr("'do not use': sigma 1 mm given; nothing installed"),
                 2);
}

TEST_F(InstallProgram, RefusesWhatDidNotConvergeUnlessForced) {
  write("out/report.json", "{\"converged\": false}");
  expect_refused("out --to robot", HasSubstr("did not converge; nothing installed"), 2);
  fs::remove(folder_ / "out/report.json");
  expect_refused("out --to robot", HasSubstr("has no report.json"), 2);
  const test::Outcome forced = run("out --to robot --force");
  EXPECT_EQ(forced.code, 0) << forced.err;
  EXPECT_THAT(forced.err, StartsWith("warning: out: has no report.json"));
  EXPECT_EQ(run("--date --to robot").out, "2026-01-02 03:04:05\n");
}

TEST_F(InstallProgram, RestoresWhatHasLostFilesOnlyIfForced) {
  EXPECT_EQ(run("out --to robot").code, 0);
  std::string older = launch();
  const std::string urdf = "calibrated_2026_01_02_03_04_05.urdf";
  older.replace(older.find(urdf), urdf.size(), "gone.urdf");
  write("robot/robot.launch.backup_1", older);
  expect_refused("--restore --to robot",
                 AllOf(HasSubstr("robot.launch.backup_1: names files that no longer exist: "
                                 "gone.urdf; "),
                       HasSubstr("--force")));
  EXPECT_EQ(run("--restore --to robot --force").code, 0);
  EXPECT_EQ(launch(), older);
}

TEST_F(InstallProgram, RefusesWrongArguments) {
  expect_refused("out", HasSubstr("--to"));
  expect_refused("--to robot", HasSubstr("a result is required"));
  expect_refused("out --restore --to robot", HasSubstr("excludes"));
  expect_refused("--date --restore --to robot", HasSubstr("excludes"));
  expect_refused("uot --to robot", HasSubstr("error: uot: cannot be read"));
  expect_refused("out --to rboot", HasSubstr("error: rboot: is not a folder"));
  expect_refused("out --to robot --launch robot/robot.launch", HasSubstr("is not the name of a"));
}

TEST_F(InstallProgram, AFileSystemThatTakesNoMoreLeavesTheRobotAsItWas) {
  // The greatest file that may be written, in blocks of 512 or 1024 bytes: none.
  const auto before = robot();
  const test::Outcome result =
      test::run_in(folder_, "bash -c \"trap '' XFSZ; ulimit -f 0; " + test::kinecal_program() +
                                " install out --to robot > /dev/null 2>&1\"");
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(robot(), before);
}

}  // namespace
}  // namespace kinecal
