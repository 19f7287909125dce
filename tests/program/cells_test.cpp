// Cells of several arms and cameras, as users meet them: robots with a URDF each, photographs of several cameras, files of
// each arm.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/run_program.hpp"
#include "support/two_arms.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::TwoArms;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Two arms that see each other's boards; no board and no stand was measured.
class CellsProgram : public test::ProgramTest {
 protected:
  CellsProgram() {
    const std::string both = TwoArms::urdf();
    write("two_arms.urdf", both);
    const std::size_t begin = both.find("<link name=\"left_0\"/>"),
                      end = both.find("<link name=\"right_0\"/>");
    std::string arm =
        "<robot name=\"six\"><link name=\"base\"/>" + both.substr(begin, end - begin) + "</robot>";
    for (std::size_t at; (at = arm.find("left_")) != std::string::npos;) arm.erase(at, 5);
    arm.replace(arm.find("\"torso\""), 7, "\"base\"");
    write("arm.urdf", arm);
    write_samples_of(arms_.samples);
  }
  void write_samples_of(const std::vector<Sample>& samples) {
    std::ofstream file(folder_ / "samples.yaml");
    write_samples(file, samples);
  }
  [[nodiscard]] test::Outcome init(const std::string& robot, const std::string& more = "") {
    return kinecal("init " + robot +
                   " --target checkerboard --arm left_hand,right_hand --camera left_eye,right_eye "
                   "--camera-type camera2d --force " +
                   more);
  }
  [[nodiscard]] test::Outcome calibrate(const std::string& urdf, const std::string& more = "") {
    return kinecal("calibrate --urdf " + urdf +
                   " --config calibrate.yaml --samples samples.yaml --output out --force " + more);
  }
  [[nodiscard]] Robot robot_of(const char* file) const { return parse_urdf(read(file), file); }

  const std::string kTwo = "--urdf left=arm.urdf --urdf right=arm.urdf";
  TwoArms arms_{5, 40, {"left_joint_2", "right_joint_3"}};
};

TEST_F(CellsProgram, RobotsWithAUrdfEachAreCalibratedInOneAndWrittenApart) {
  const test::Outcome made = init(kTwo);
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("wrote robots.urdf: "), HasSubstr("left_joint_0")));
  EXPECT_THAT(read("calibrate.yaml"), HasSubstr("name: world_right"));
  const test::Outcome done = calibrate("robots.urdf", "--between left_base,right_base");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("Pose of 'right_base' in 'left_base': +- "));
  const Robot all = robot_of("out/calibrated.urdf");
  EXPECT_LE((all.joint("world_right").origin.translation - Vector3<double>(0, -0.5, 0)).norm(),
            0.01);
  for (const char* name : {"left", "right"}) {
    const std::string file = fmt::format("out/calibrated_{}.urdf", name);
    EXPECT_EQ(robot_of(file.c_str()).name(), "six");
    EXPECT_EQ(robot_of(file.c_str()).joints().size(), robot_of("arm.urdf").joints().size());
    EXPECT_THAT(read(file.c_str()), AllOf(HasSubstr("rising="), Not(HasSubstr("left_"))));
  }
}

TEST_F(CellsProgram, AGuessOfWhereARobotStandsIsWhereTheSearchBegins) {
  const test::Outcome made = init(kTwo, "--stands right=0.05,-0.45,0,0,0,0.1");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(read("robots.urdf"), HasSubstr("<origin xyz=\"0.05 -0.45 0\" rpy=\"0 0 0.1\"/>"));
  const test::Outcome done = calibrate("robots.urdf");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_LE((robot_of("out/calibrated.urdf").joint("world_right").origin.translation -
             Vector3<double>(0, -0.5, 0))
                .norm(),
            0.01);
}

TEST_F(CellsProgram, SaysWhatIsWrongWithSeveralUrdfs) {
  const auto refusal = [&](const std::string& robot) {
    const test::Outcome made = init(robot);
    EXPECT_EQ(made.code, 1) << made.out;
    EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
    EXPECT_FALSE(fs::exists(folder_ / "robots.urdf"));
    return made.err;
  };
  EXPECT_THAT(refusal("--urdf arm.urdf --urdf arm.urdf"), HasSubstr("--urdf left=FILE"));
  EXPECT_THAT(refusal("--urdf a=arm.urdf --urdf a=arm.urdf"),
              HasSubstr("two robots are called 'a'"));
  EXPECT_THAT(refusal(kTwo + " --stands rihgt=0,0,0,0,0,0"),
              AllOf(HasSubstr("--stands: no robot 'rihgt'"), HasSubstr("did you mean 'right'")));
  EXPECT_THAT(refusal(kTwo + " --stands right=0,0,0"), HasSubstr("six numbers"));
  EXPECT_THAT(refusal("--urdf arm.urdf --stands right=0,0,0,0,0,0"),
              HasSubstr("--urdf names none"));
  EXPECT_THAT(refusal("--urdf left=arm.urdf --urdf right=nothing.urdf"), HasSubstr("nothing.urdf"));
}

TEST_F(CellsProgram, JointsWithoutTheRobotsNameAreNamedAsExpected) {
  ASSERT_EQ(init(kTwo).code, 0);
  std::vector<Sample> samples = arms_.samples;
  for (Sample& sample : samples) {
    for (std::string& name : sample.joint_names) {
      name = name.starts_with("left_") ? name.substr(5) : "other_" + name;
    }
  }
  write_samples_of(samples);
  const test::Outcome done = calibrate("robots.urdf");
  EXPECT_EQ(done.code, 1);
  const auto expected = HasSubstr(
      "the samples have 'joint_0': name joints as the URDF does, 'left_joint_0' or "
      "'right_joint_0'");
  EXPECT_THAT(done.err, expected);
  EXPECT_THAT(kinecal("init --urdf robots.urdf --from samples.yaml --force").err, expected);
}

TEST_F(CellsProgram, EachArmHasAFileOfItsKinematicsAndZerosAreOneList) {
  ASSERT_EQ(init("--urdf two_arms.urdf").code, 0);
  const std::string files =
      "--kinematics left_=left.yaml --kinematics right_=right.yaml --zeros zeros.yaml ";
  const test::Outcome done = calibrate("two_arms.urdf", files + "--degrees");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(read("left.yaml"), AllOf(HasSubstr("  left_joint_2:"), Not(HasSubstr("right_"))));
  EXPECT_THAT(read("right.yaml"), AllOf(HasSubstr("  right_joint_3:"), Not(HasSubstr("left_"))));
  EXPECT_EQ(read("left.yaml"), read("out/kinematics_left.yaml"));
  EXPECT_EQ(read("right.yaml"), read("out/kinematics_right.yaml"));
  const std::string zeros = read("zeros.yaml");
  EXPECT_THAT(zeros, HasSubstr("# Units: degrees and millimetres"));
  const std::size_t at = zeros.find("left_joint_2: ");
  ASSERT_NE(at, std::string::npos) << zeros;
  constexpr double kDegrees = 57.29577951308232, kNear = 0.3;  // ten times its ±
  EXPECT_NEAR(std::stod(zeros.substr(at + 14)), kDegrees * arms_.zeros.at("left_joint_2"), kNear);
  const test::Outcome radians = calibrate("two_arms.urdf", "--zeros zeros.yaml");
  ASSERT_EQ(radians.code, 0) << radians.err;
  EXPECT_THAT(radians.err, HasSubstr("zeros.yaml: the file before is kept as zeros.yaml.backup_1"));
  EXPECT_EQ(read("zeros.yaml.backup_1"), zeros);
  EXPECT_THAT(read("zeros.yaml"), HasSubstr("# Units: radians and metres"));
}

/// What a factory measured is not replaced by the numbers of a URDF that was made without it.
TEST_F(CellsProgram, AFactorysFileOfOneArmIsKept) {
  ASSERT_EQ(init("--urdf two_arms.urdf").code, 0);
  const std::string factory =
      "kinematics:\n  left_joint_1: {x: 0.0504, y: 0.01, z: 0, roll: 0, pitch: 0, yaw: 0}\n";
  write("left.yaml", factory);
  write("zeros.yaml", "left_joint_1: 0.1\n");
  const test::Outcome done = calibrate("two_arms.urdf", "--kinematics left_=left.yaml");
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.err, AllOf(HasSubstr("left.yaml: the URDF was not made with this file"),
                              HasSubstr("left_joint_1 by 0.4 mm")));
  EXPECT_EQ(read("left.yaml"), factory);
  EXPECT_THAT(calibrate("two_arms.urdf", "--zeros zeros.yaml").err,
              HasSubstr("zeros.yaml: exists, and kinecal has not written it"));
  EXPECT_THAT(calibrate("two_arms.urdf", "--kinematics lfet_=other.yaml").err,
              HasSubstr("no joint of the robot begins with 'lfet_'"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CellsProgram, NamesSensorsThatAreTwiceOrOnNoArm) {
  ASSERT_EQ(init("--urdf two_arms.urdf").code, 0);
  std::vector<Sample> samples = arms_.samples;
  for (Sample& sample : samples) sample.observations.push_back(sample.observations.back());
  write_samples_of(samples);
  const test::Outcome twice = calibrate("two_arms.urdf");
  EXPECT_EQ(twice.code, 1);
  EXPECT_THAT(twice.err, AllOf(HasSubstr("samples.yaml:"), HasSubstr("_eye"), HasSubstr("twice")));
  samples = arms_.samples;
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor == "right_hand") seen.sensor = "third_hand";
    }
  }
  write_samples_of(samples);
  const test::Outcome unknown = calibrate("two_arms.urdf");
  EXPECT_THAT(unknown.out + unknown.err,
              AllOf(HasSubstr("model 'right_hand': no sample has a sensor of that name"),
                    HasSubstr("'third_hand'")));
  EXPECT_THAT(unknown.out, HasSubstr("verdict: use with care"));
  const test::Outcome from = kinecal("init --urdf two_arms.urdf --from samples.yaml --force");
  EXPECT_EQ(from.code, 1) << from.out;
  EXPECT_THAT(from.err,
              HasSubstr("--from: 'third_hand' holds a target, as 'left_hand' does, and is "
                        "no link of the URDF of 'two_arms'"));
}

#if defined(KINECAL_HAVE_PNG) && defined(KINECAL_HAVE_APRILTAG)
/// Two cameras on stands photograph a grid of tags in the hand of a Panda, each in poses of its own.
class CellPhotographs : public test::ProgramTest {
 protected:
  CellPhotographs() {
    const std::string panda = test::source_folder() + "/examples/robots/panda/panda.urdf";
    std::ifstream in(panda);
    std::string urdf{std::istreambuf_iterator<char>(in), {}}, cameras;
    for (const auto& [name, origin] :
         {std::pair("left", R"(xyz="1.4 0 0.6" rpy="-1.5708 0 1.5708")"),
          std::pair("right", R"(xyz="0 1.4 0.6" rpy="-1.5708 0 3.1416")")}) {
      cameras += fmt::format(
          "<link name=\"{0}\"/><joint name=\"{0}_joint\" type=\"fixed\"><parent "
          "link=\"panda_link0\"/><child link=\"{0}\"/><origin {1}/></joint>\n",
          name, origin);
    }
    write("cell.urdf", urdf.insert(urdf.rfind("</robot>"), cameras));
    fs::create_directories(folder_ / "images");
    for (const std::string name : {"left", "right"}) photograph(name);
  }

  /// Poses of a camera: "left_0001.png" in the table, of both cameras together.
  void photograph(const std::string& camera) {
    write(camera + "_scene.yaml",
          fmt::format("camera: {{frame: {0}, name: {0}, type: camera2d}}\n"
                      "target: {{type: apriltag, link: panda_link8, columns: 4, rows: 3, size: "
                      "0.05, xyz: [-0.1, 0.07, 0.06], rpy: [3.14159, 0, 0]}}\n"
                      "errors: {{joint: 0, position: 0, rotation: 0, intrinsics: 0}}\n",
                      camera));
    const test::Outcome made =
        kinecal(fmt::format("simulate cell.urdf --scene {0}_scene.yaml --poses 14 -o {0}", camera));
    ASSERT_EQ(made.code, 0) << made.err;
    fs::create_directories(folder_ / "images" / camera);
    for (const auto& image : fs::directory_iterator(folder_ / camera / "images")) {
      fs::rename(image.path(),
                 folder_ / "images" / camera / (camera + "_" + image.path().filename().string()));
    }
    std::istringstream rows(read((camera + "/poses.csv").c_str()));
    std::string row;
    std::getline(rows, row);
    if (table_.empty()) table_ = row + "\n";
    while (std::getline(rows, row)) table_ += camera + "_" + row + "\n";
    write("poses.csv", table_);
    fs::rename(folder_ / camera / "camera.yaml", folder_ / (camera + ".yaml"));
  }
  void fill_in_board() {
    std::string text = read("capture.yaml");
    for (const auto& [from, to] :
         {std::pair("columns: 0 ", "columns: 4 "), std::pair("rows: 0 ", "rows: 3 "),
          std::pair("size: 0.0 ", "size: 0.05 "), std::pair("spacing: 0.3 ", "spacing: 0.25 ")}) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, std::string(from).size(), to);
    }
    write("capture.yaml", text);
  }

  std::string table_;
};

TEST_F(CellPhotographs, OfCamerasWithPosesOfTheirOwnCalibrateAll) {
  ASSERT_EQ(kinecal("init --urdf cell.urdf --target apriltag --arm panda_link8 --camera left,right "
                    "--camera-type camera2d")
                .code,
            0);
  fill_in_board();
  const std::string detect =
      "detect capture.yaml --images images --poses poses.csv --frame left,right --urdf cell.urdf "
      "--force -o samples.yaml";
  const test::Outcome found = kinecal(detect);
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr(" of 28 images"));
  EXPECT_THAT(found.err, Not(HasSubstr("photographs of one name")));
  const std::string samples = read("samples.yaml");
  EXPECT_THAT(samples, AllOf(HasSubstr("left"), HasSubstr("right"), HasSubstr("panda_joint1")));
  const test::Outcome done = kinecal(
      "calibrate --urdf cell.urdf --config calibrate.yaml --samples samples.yaml --camera "
      "left=left.yaml --camera right=right.yaml --between left,right --report report.html "
      "--output calibrated");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("Pose of 'right' in 'left': +- "));
  const Robot robot = parse_urdf(read("calibrated/calibrated.urdf"), "calibrated.urdf");
  const Vector3<double> left = robot.joint("left_joint").origin.translation,
                        right = robot.joint("right_joint").origin.translation;
  EXPECT_NEAR((left - right).norm(), std::sqrt(2.0) * 1.4, 5e-3);
  EXPECT_THAT(read("report.html"), HasSubstr("Which camera saw which pose"));
  fs::rename(folder_ / "images/right/right_0003.png", folder_ / "images/right/right_0033.png");
  const test::Outcome missing = kinecal(detect);
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.err, HasSubstr("image 'right_0003.png' is not in images/left, nor in that of "
                                     "another camera"));
}
#endif

}  // namespace
}  // namespace kinecal
