#include "kinecal/tools/install/install.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kinecal/tools/install/launch_folder.ipp"
#include "support/launch_scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::UnorderedElementsAre;

class Install : public test::InstallScene {
 protected:
  Installation install(const std::vector<std::string>& names = {}) {
    return kinecal::install(read_result_folder(folder_ / "out"), folder_ / "robot", "robot.launch",
                            launch_names(names), diagnostics_);
  }
  std::string restore() { return restore_installed(folder_ / "robot", "robot.launch"); }
  [[nodiscard]] std::string date() const {
    return installed_date(folder_ / "robot", "robot.launch", fetch_launch_names());
  }
  /// Another result, a day later.
  void recalibrate(const std::string& z = "2") {
    for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
      if (entry.path().extension() != ".yaml") continue;
      if (entry.path().stem().string().starts_with("calibration")) {
        fs::rename(entry.path(), folder_ / "out/calibration_2026_01_03_03_04_05.yaml");
        break;
      }
    }
    write("out/calibrated.urdf", urdf(z));
  }
  /// Installing is refused with this message and changes nothing.
  void expect_refused(const testing::Matcher<std::string>& message,
                      const std::vector<std::string>& names = {}) {
    const auto before = robot();
    EXPECT_THAT(test::thrown<std::runtime_error>([&] { install(names); }), message);
    EXPECT_EQ(robot(), before);
  }

  Diagnostics diagnostics_;
};

TEST_F(Install, PutsFilesBesideTheLaunchFileAndNamesThemThere) {
  const Installation done = install();
  EXPECT_THAT(done.added, UnorderedElementsAre("calibrated_2026_01_02_03_04_05.urdf",
                                               "depth_camera_2026_01_02_03_04_05.yaml",
                                               "rgb_camera_2026_01_02_03_04_05.yaml"));
  EXPECT_EQ(done.backup, "robot.launch.backup_1");
  EXPECT_EQ(read("robot/robot.launch.backup_1"), test::kLaunch);
  EXPECT_EQ(read("robot/calibrated_2026_01_02_03_04_05.urdf"), read("out/calibrated.urdf"));
  std::string expected = test::kLaunch;
  const auto replace = [&](const std::string& from, const std::string& to) {
    expected.replace(expected.find(from), from.size(), to);
  };
  const std::string robot = (folder_ / "robot").string();
  replace("uncalibrated", "2026-01-02 03:04:05");
  replace("$(find robot)/robot.urdf", robot + "/calibrated_2026_01_02_03_04_05.urdf");
  replace("offset_mm\" value=\"0\"", "offset_mm\" value=\"-2\"");  // int(-2.5)
  replace("\"1.0\" />", "\"1.01\" />");
  replace("$(find robot)/rgb.yaml", robot + "/rgb_camera_2026_01_02_03_04_05.yaml");
  replace("$(find robot)/depth.yaml", robot + "/depth_camera_2026_01_02_03_04_05.yaml");
  EXPECT_EQ(launch(), expected);
  EXPECT_EQ(robot.size() + 1, (folder_ / "robot/").string().size());
  EXPECT_EQ(InstallScene::robot().size(), 5u) << "left something";
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(Install, LeavesTheRobotsModelIfTheResultIsOfASensorAlone) {
  for (const std::string sensor : {"sensor", "magnetometer"}) {
    write("robot/robot.launch", test::kLaunch);
    write("out/calibrated.urdf", "<robot name=\"base\"><link name=\"base_link\"/><link name=\"" +
                                     sensor + "\"/><joint name=\"" + sensor +
                                     "_joint\" type=\"fixed\"><parent link=\"base_link\"/><child "
                                     "link=\"" +
                                     sensor + "\"/></joint></robot>");
    install();
    EXPECT_THAT(launch(), HasSubstr("$(find robot)/robot.urdf"));
    EXPECT_THAT(launch(), HasSubstr("2026-01-02 03:04:05"));
    EXPECT_FALSE(fs::exists(folder_ / "robot/calibrated_2026_01_02_03_04_05.urdf"));
    EXPECT_THAT(diagnostics_.warnings.back(), HasSubstr("robot_description is left as it is"));
  }
}

TEST_F(Install, KeepsTheByteOrderMark) {
  write("robot/robot.launch", std::string("\xEF\xBB\xBF") + test::kLaunch);
  install();
  EXPECT_THAT(launch(), StartsWith("\xEF\xBB\xBF<?xml version=\"1.0\"?>\r\n<launch>\n"));
  EXPECT_EQ(date(), "2026-01-02 03:04:05");
}

TEST_F(Install, InstallingWhatIsInstalledChangesNothing) {
  install();
  const auto before = robot();
  const Installation again = install();
  EXPECT_THAT(again.added, IsEmpty());
  EXPECT_EQ(again.backup, "");
  EXPECT_EQ(robot(), before);
}

TEST_F(Install, BringsBackAFileThatWasDeleted) {
  install();
  const auto before = robot();
  fs::remove(folder_ / "robot/rgb_camera_2026_01_02_03_04_05.yaml");
  EXPECT_THAT(install().added, ElementsAre("rgb_camera_2026_01_02_03_04_05.yaml"));
  EXPECT_EQ(robot(), before);
}

TEST_F(Install, AnotherResultOfTheSameSecondGetsItsOwnFiles) {
  install();
  write("out/calibrated.urdf", urdf("3"));
  install();
  EXPECT_EQ(read("robot/calibrated_2026_01_02_03_04_05.urdf"), urdf("1"));
  EXPECT_EQ(read("robot/calibrated_2026_01_02_03_04_05_2.urdf"), urdf("3"));
  EXPECT_THAT(launch(), HasSubstr("/calibrated_2026_01_02_03_04_05_2.urdf"));
}

TEST_F(Install, RestoresBackToTheOldest) {
  install();
  const std::string first = launch();
  recalibrate();
  EXPECT_EQ(install().backup, "robot.launch.backup_2");
  const std::string second = launch();
  EXPECT_EQ(date(), "2026-01-03 03:04:05");
  EXPECT_EQ(restore(), "robot.launch.undone_2");
  EXPECT_EQ(launch(), first);
  EXPECT_EQ(date(), "2026-01-02 03:04:05");
  EXPECT_EQ(restore(), "robot.launch.undone_1");
  EXPECT_EQ(launch(), test::kLaunch);
  EXPECT_EQ(date(), "uncalibrated");
  const auto before = robot();
  EXPECT_THROW(restore(), InputError);
  EXPECT_EQ(robot(), before);
  EXPECT_EQ(read("robot/robot.launch.undone_2"), second);
  EXPECT_EQ(read("robot/robot.launch.undone_1"), first);
  install();  // and forth again
  EXPECT_EQ(launch(), second);
  EXPECT_EQ(restore(), "robot.launch.undone_2");
  EXPECT_EQ(launch(), test::kLaunch);
}

TEST_F(Install, RestoringLosesNothingThatWasWrittenByHand) {
  install();
  spoil("robot/robot.launch", "<!-- end -->", "<!-- mine -->");
  const std::string edited = launch();
  EXPECT_EQ(restore(), "robot.launch.undone_1");
  install();
  EXPECT_EQ(restore(), "robot.launch.undone_2");
  EXPECT_EQ(read("robot/robot.launch.undone_1"), edited);
}

TEST_F(Install, TheFolderMayBeThatOfTheResult) {
  write("out/robot.launch", test::kLaunch);
  (void)kinecal::install(read_result_folder(folder_ / "out"), folder_ / "out", "robot.launch",
                         fetch_launch_names(), diagnostics_);
  EXPECT_EQ(read("out/calibrated_2026_01_02_03_04_05.urdf"), urdf("1"));
  EXPECT_EQ(read("out/calibrated.urdf"), urdf("1"));
}

TEST_F(Install, RestoringNeedsABackup) {
  EXPECT_THAT(test::thrown<InputError>([&] { restore(); }),
              HasSubstr("robot.launch: there is nothing to restore"));
}

TEST_F(Install, TheNewestBackupIsTheGreatestNumberNotTheLastLetter) {
  write("robot/robot.launch.backup_9", "<launch>nine</launch>");
  write("robot/robot.launch.backup_10", "<launch>ten</launch>");
  write("robot/robot.launch.backup_11.old", "no backup");
  restore();
  EXPECT_EQ(launch(), "<launch>ten</launch>");
}

TEST_F(Install, RestoresNothingThatTheRobotCouldNotStartFrom) {
  install();
  recalibrate();
  install();
  fs::remove(folder_ / "robot/calibrated_2026_01_02_03_04_05.urdf");
  fs::remove(folder_ / "robot/rgb_camera_2026_01_02_03_04_05.yaml");
  const auto before = robot();
  EXPECT_THAT(test::thrown<InputError>([&] { restore(); }),
              AllOf(HasSubstr("robot.launch.backup_2: names files that no longer "
                              "exist: calibrated_2026_01_02_03_04_05.urdf, "
                              "rgb_camera_2026_01_02_03_04_05.yaml; "),
                    HasSubstr("--force")));
  EXPECT_EQ(robot(), before);
  (void)restore_installed(folder_ / "robot", "robot.launch", true);
  EXPECT_EQ(date(), "2026-01-02 03:04:05");
}

TEST_F(Install, FilesElsewhereAreNoMatterOfARestoration) {
  spoil("robot/robot.launch", "$(find robot)/rgb.yaml", "/home/robot/rgb_that_never_was.yaml");
  install();
  restore();
  EXPECT_THAT(launch(), HasSubstr("file:///home/robot/rgb_that_never_was.yaml"));
}

TEST_F(Install, ABackupThatIsNotALaunchFileIsNotRestored) {
  install();
  const std::string installed = launch();
  write("robot/robot.launch.backup_1", "<launch>cut o");
  EXPECT_THROW(restore(), InputError);
  EXPECT_EQ(launch(), installed);
}

TEST_F(Install, KeepsWhoMayReadTheLaunchFile) {
  fs::permissions(folder_ / "robot/robot.launch", fs::perms(0640));
  install();
  for (const char* name : {"robot.launch", "calibrated_2026_01_02_03_04_05.urdf"}) {
    EXPECT_EQ(fs::status(folder_ / "robot" / name).permissions(), fs::perms(0640)) << name;
  }
}

TEST_F(Install, OfALinkTheBackupHasTheContent) {
  write("package.launch", test::kLaunch);
  fs::remove(folder_ / "robot/robot.launch");
  fs::create_symlink("../package.launch", folder_ / "robot/robot.launch");
  install();
  EXPECT_EQ(read("package.launch"), test::kLaunch);
  EXPECT_FALSE(fs::is_symlink(folder_ / "robot/robot.launch"));
  EXPECT_FALSE(fs::is_symlink(folder_ / "robot/robot.launch.backup_1"));
  write("package.launch", "<launch/>");  // later, a new version of the package
  EXPECT_EQ(read("robot/robot.launch.backup_1"), test::kLaunch);
  restore();
  EXPECT_FALSE(fs::is_symlink(folder_ / "robot/robot.launch"));
  EXPECT_EQ(launch(), test::kLaunch);
}

TEST_F(Install, WarnsThatALinkIsReplaced) {
  write("package.launch", test::kLaunch);
  fs::remove(folder_ / "robot/robot.launch");
  fs::create_symlink("../package.launch", folder_ / "robot/robot.launch");
  install();
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("robot.launch: is a symbolic link to ../package.launch; "
                                    "a file replaces the link")));
}

TEST_F(Install, ANameCanBeAnotherOrNone) {
  spoil("robot/robot.launch", "head_camera/driver/z_scaling", "cam/scale");
  spoil("robot/robot.launch", "  <param name=\"head_camera/driver/z_offset_mm\" value=\"0\" />\n",
        "");
  expect_refused(AllOf(HasSubstr("no param 'head_camera/driver/z_offset_mm'"), HasSubstr("\n"),
                       HasSubstr("no param 'head_camera/driver/z_scaling'")));
  install({"z_scaling=cam/scale", "z_offset_mm="});
  EXPECT_THAT(launch(), HasSubstr("\"cam/scale\" value=\"1.01\""));
}

TEST_F(Install, ASecondCameraIsSetWhereItsKeysAreNamed) {
  write("out/rgb_left.yaml", camera("700.0"));
  spoil("out/calibration_2026_01_02_03_04_05.yaml", "urdf:", "left_rgb_info: rgb_left.yaml\nurdf:");
  install();
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("left_rgb_camera_info_url is not set")));
  EXPECT_TRUE(fs::exists(folder_ / "robot/rgb_left_2026_01_02_03_04_05.yaml"));
  spoil("robot/robot.launch", "</launch>", "<arg name=\"left\" default=\"\"/></launch>");
  install({"left_rgb_camera_info_url=left"});
  EXPECT_THAT(launch(), HasSubstr("/rgb_left_2026_01_02_03_04_05.yaml\"/></launch>"));
  expect_refused(HasSubstr("did you mean 'left_rgb_camera_info_url'?"),
                 {"lfet_rgb_camera_info_url=left"});
}

TEST_F(Install, ADepthCameraThatCorrectsNothingIsSetSo) {
  write("out/calibration_2026_01_02_03_04_05.yaml",
        "depth_info: depth_camera.yaml\nrgb_info: rgb_camera.yaml\nurdf: calibrated.urdf\n");
  spoil("robot/robot.launch", "value=\"0\"", "value=\"7\"");
  install();
  EXPECT_THAT(launch(), AllOf(HasSubstr("z_offset_mm\" value=\"0\""),
                              HasSubstr("z_scaling\" value=\"1.0\"")));
}

TEST_F(Install, WithoutCamerasTheirNamesAreNotMissed) {
  write("out/calibration_2026_01_02_03_04_05.yaml", "elbow: 0.02\nurdf: calibrated.urdf\n");
  write("robot/robot.launch",
        "<launch><param name='calibration_date' value=''/>"
        "<param name='robot_description' command='cat a.urdf'/></launch>");
  install();
  EXPECT_EQ(launch(),
            "<launch><param name='calibration_date' value='2026-01-02 03:04:05'/>"
            "<param name='robot_description' textfile='" +
                (folder_ / "robot/calibrated_2026_01_02_03_04_05.urdf").string() + "'/></launch>");
}

/// The result of a mobile base, and a launch file as Fetch's installer leaves it: no blanks before "/>".
class InstallBase : public Install {
 protected:
  static constexpr const char* kBefore =
      "<launch>\n  <param name=\"calibration_date\" value=\"uncalibrated\"/>\n"
      "  <param name=\"base_controller/track_width\" value=\"0.37476\"/>\n";
  static constexpr const char* kAfter =
      "  <param name=\"robot_description\" textfile=\"a.urdf\"/>\n</launch>";

  InstallBase() {
    write("out/calibration_2026_01_02_03_04_05.yaml",
          "base: base_calibration.yaml\nurdf: calibrated.urdf\n");
    write_base("odom: 0.390056326531\nimu: 0.001191185775\n");
    write("robot/robot.launch", std::string(kBefore) + kAfter);
  }
  void write_base(const std::string& of_ros1) {
    write("out/base_calibration.yaml",
          "track_width_scale: 1.02  # +- 0.0004\nrollout_scale: 1.0\nimu_scale: 0.975\n" + of_ros1);
  }
};

/// What calibrate_robot of fetch_calibration sets: str() of odom and imu.
TEST_F(InstallBase, SetsWhatFetchsInstallerSets) {
  write("robot/robot.launch", std::string(kBefore) +
                                  "  <param name=\"/imu/gyro_scale\" value=\"0.001221729\"/>\n" +
                                  kAfter);
  install();
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  EXPECT_EQ(launch(),
            "<launch>\n  <param name=\"calibration_date\" value=\"2026-01-02 03:04:05\"/>\n"
            "  <param name=\"base_controller/track_width\" value=\"0.390056326531\"/>\n"
            "  <param name=\"/imu/gyro_scale\" value=\"0.001191185775\"/>\n"
            "  <param name=\"robot_description\" textfile=\"" +
                (folder_ / "robot/calibrated_2026_01_02_03_04_05.urdf").string() +
                "\"/>\n</launch>");
  const auto before = robot();
  EXPECT_EQ(install().backup, "");  // nothing is multiplied again
  EXPECT_EQ(robot(), before);
  restore();
  EXPECT_THAT(launch(), HasSubstr("value=\"0.37476\""));
}

TEST_F(InstallBase, NumbersAreAsPythonWritesThem) {
  for (const auto& [in_file, installed] :
       {std::pair("1.0", "1.0"), std::pair("0.370", "0.37"), std::pair("1.0e-05", "1e-05"),
        std::pair("0.0001", "0.0001")}) {
    write_base(std::string("odom: ") + in_file + "\n");
    write("robot/robot.launch", std::string(kBefore) + kAfter);
    install({"gyro_scale="});
    EXPECT_THAT(launch(), HasSubstr(std::string("track_width\" value=\"") + installed + "\""));
  }
}

/// Fetch's own launch file has no place for the gyroscope.
TEST_F(InstallBase, AGyroscopeWithoutAPlaceIsSaid) {
  install();
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("gyro_scale is not set to 0.001191185775: the launch file has "
                                    "no param 'imu/gyro_scale'")));
  EXPECT_THAT(launch(), HasSubstr("track_width\" value=\"0.390056326531\""));
}

TEST_F(InstallBase, ALaunchFileWithoutATrackWidthIsRefused) {
  spoil("robot/robot.launch", "base_controller/track_width", "base_controller/width");
  expect_refused(AllOf(HasSubstr("no param 'base_controller/track_width'"),
                       HasSubstr("--name track_width=NAME names another one")));
  install({"track_width=base_controller/width"});
  EXPECT_THAT(launch(), HasSubstr("base_controller/width\" value=\"0.390056326531\""));
}

TEST_F(InstallBase, ScalesAloneAndARolloutAreSaid) {
  write("out/base_calibration.yaml", "track_width_scale: 1.02\nrollout_scale: 0.98\n");
  install();
  EXPECT_THAT(
      diagnostics_.warnings,
      ElementsAre(HasSubstr("track_width is not set: base_calibration.yaml has track_width_scale "
                            "1.02, not odom; give the error block the driver's track_width"),
                  HasSubstr("rollout_scale 0.98: not set, as Fetch's launch file has no place")));
  EXPECT_THAT(launch(), HasSubstr("value=\"0.37476\""));
}

TEST_F(InstallBase, AFileOfParametersOfRos2IsRefused) {
  write("robot/base.yaml", "/**:\n  ros__parameters: {wheel_separation: 0.37}\n");
  EXPECT_THAT(test::thrown<InputError>([&] {
                (void)kinecal::install(read_result_folder(folder_ / "out"), folder_ / "robot",
                                       "base.yaml", fetch_launch_names(), diagnostics_);
              }),
              AllOf(HasSubstr("'base.yaml': is one of ROS 2"),
                    HasSubstr("track_width_scale as wheel_separation_multiplier")));
}

TEST_F(Install, WithoutADateInItsNameAResultIsOfWhenItWasWritten) {
  fs::rename(folder_ / "out/calibration_2026_01_02_03_04_05.yaml",
             folder_ / "out/calibration.yaml");
  const timespec times[2] = {{1767322800, 0}, {1767322800, 0}};  // 2026-01-02 03:00:00 UTC
  ASSERT_EQ(utimensat(AT_FDCWD, (folder_ / "out/calibration.yaml").c_str(), times, 0), 0);
  install();
  EXPECT_THAT(date(), testing::ContainsRegex("^2026-01-0[123] [0-9][0-9]:[0-9][0-9]:00$"));
}

TEST_F(Install, OfSeveralDatedResultsTheNewestIsInstalled) {
  write("out/calibration_2025_01_02_03_04_05.yaml", "urdf: gone.urdf\n");
  install();
  EXPECT_EQ(date(), "2026-01-02 03:04:05");
  write("out/calibration.yaml", "urdf: calibrated.urdf\n");
  expect_refused(HasSubstr("has both calibration.yaml and calibration_202"));
}

TEST_F(Install, RefusesAnIncompleteOrBrokenResult) {
  fs::remove(folder_ / "out/rgb_camera.yaml");
  expect_refused(HasSubstr("calibration_2026_01_02_03_04_05.yaml:5: rgb_camera.yaml is not there"));
  write("out/rgb_camera.yaml", "camera_matrix: [1, 2");
  expect_refused(HasSubstr("rgb_camera.yaml:"));
  write("out/rgb_camera.yaml", camera("0.0"));
  expect_refused(HasSubstr("rgb_camera.yaml:4: focal lengths 0 and 0 are not"));
  write("out/rgb_camera.yaml", camera("500.0"));
  write("out/calibrated.urdf", urdf("1").substr(0, 60));
  expect_refused(HasSubstr("calibrated.urdf:1: malformed XML"));
  fs::remove(folder_ / "out/calibrated.urdf");
  expect_refused(HasSubstr("calibrated.urdf is not there"));
  fs::remove_all(folder_ / "out");
  expect_refused(HasSubstr("out: cannot be read"));
  fs::create_directory(folder_ / "out");
  expect_refused(HasSubstr("has no calibration.yaml"));
}

TEST_F(Install, ReadsWhetherTheResultConverged) {
  EXPECT_EQ(read_result_folder(folder_ / "out").converged, true);
  write("out/report.json", "{\"converged\": false}");
  EXPECT_EQ(read_result_folder(folder_ / "out").converged, false);
  write("out/report.json",
        R"({"verdict": "do not use", "reasons": ["sigma 1 mm given"], "converged": true})");
  EXPECT_EQ(read_result_folder(folder_ / "out").refusal, "sigma 1 mm given");
  fs::remove(folder_ / "out/report.json");
  EXPECT_EQ(read_result_folder(folder_ / "out").converged, std::nullopt);
  write("out/report.json", "{}");
  EXPECT_THROW((void)read_result_folder(folder_ / "out"), InputError);
}

TEST_F(Install, RefusesALaunchFileThatIsNotThereWithTheNearest) {
  fs::rename(folder_ / "robot/robot.launch", folder_ / "robot/robto.launch");
  expect_refused(AllOf(HasSubstr("robot/robot.launch: is not there"),
                       HasSubstr("did you mean 'robto.launch'?")));
  EXPECT_THROW((void)detail::LaunchFolder(folder_ / "robot", "../a.launch"), InputError);
  EXPECT_THROW((void)detail::LaunchFolder(folder_ / "rob", "robot.launch"), InputError);
}

TEST_F(Install, RefusesAnOffsetThatIsNotFinite) {
  spoil("out/calibration_2026_01_02_03_04_05.yaml", "-0.0025", ".inf");
  expect_refused(HasSubstr("z_offset of inf m"));
}

TEST_F(Install, RefusesAPathThatALaunchFileWouldSubstitute) {
  fs::rename(folder_ / "robot", folder_ / "$(x)");
  EXPECT_THROW(kinecal::install(read_result_folder(folder_ / "out"), folder_ / "$(x)",
                                "robot.launch", fetch_launch_names(), diagnostics_),
               InputError);
}

/// A sensor may have any name, and its file has the same.
TEST_F(Install, RefusesAFileThatALaunchFileWouldSubstitute) {
  fs::rename(folder_ / "out/rgb_camera.yaml", folder_ / "out/rgb_$(env HOME).yaml");
  spoil("out/calibration_2026_01_02_03_04_05.yaml", "rgb_camera.yaml", "rgb_$(env HOME).yaml");
  expect_refused(AllOf(HasSubstr("robot.launch:8: arg 'rgb_camera_info_url': 'file://"),
                       HasSubstr("rgb_$(env HOME)_2026"), HasSubstr("rename")));
}

TEST_F(Install, CountsItsBackupsAndNotFilesWithHugeNumbers) {
  write("robot/robot.launch.backup_2147483647", "<launch>other</launch>");
  EXPECT_EQ(install().backup, "robot.launch.backup_1");
  restore();
  EXPECT_EQ(launch(), test::kLaunch);
  write("robot/robot.launch.backup_999999999", "<launch>last</launch>");
  expect_refused(HasSubstr("robot.launch.backup_999999999 has the last number; rename it"));
}

TEST_F(Install, AFolderThatCannotBeWrittenToIsLeftAlone) {
  if (geteuid() == 0) GTEST_SKIP() << "root writes everywhere";
  fs::permissions(folder_ / "robot", fs::perms(0555));
  expect_refused(HasSubstr("cannot be written to: Permission denied"));
  EXPECT_THROW(restore(), std::runtime_error);
  fs::permissions(folder_ / "robot", fs::perms(0755));
}

}  // namespace
}  // namespace kinecal
