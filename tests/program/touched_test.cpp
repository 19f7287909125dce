// An arm and nothing to measure with, as its user meets it: from a table of joints to a URDF, and what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "kinecal/files/samples/read_samples.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Touched : public test::ProgramTest {
 protected:
  Touched() {
    const fs::path examples = fs::path(test::source_folder()) / "examples";
    fs::copy(examples / "csv/cone.csv", folder_);
    fs::copy(examples / "robots/ur5e/ur5e.urdf", folder_);
  }
};

TEST_F(Touched, TheTableOfAConeCalibratesAsTheManualSays) {
  const Outcome made = kinecal("init --urdf ur5e.urdf --from cone.csv --target point --arm tool0");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("from the samples: target point; arm tool0"));
  ASSERT_EQ(kinecal("convert cone.csv samples.yaml --columns columns.yaml").code, 0);
  const Outcome done = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output out "
      "--report r.json");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("verdict: good"));
  constexpr double kDegree = 0.017453292519943295;
  const std::map<std::string, double> truth = {{"shoulder_lift_joint", 0.31 * kDegree},
                                               {"elbow_joint", -0.42 * kDegree},
                                               {"wrist_1_joint", 0.37 * kDegree},
                                               {"wrist_2_joint", -0.28 * kDegree},
                                               {"tip_x", 0.012},
                                               {"tip_y", -0.008},
                                               {"tip_z", 0.145}};
  std::size_t found = 0;
  const auto report = nlohmann::json::parse(read("r.json"));
  for (const auto& parameter : report.at("parameters")) {
    const auto true_value = truth.find(parameter.at("name").get<std::string>());
    if (true_value == truth.end()) continue;
    ++found;
    EXPECT_NEAR(parameter.at("value").get<double>(), true_value->second,
                4.0 * parameter.at("sigma").get<double>())
        << true_value->first;
  }
  EXPECT_EQ(found, truth.size());
}

TEST_F(Touched, JointsAloneAskWhatTheTipTouched) {
  const Outcome asked = kinecal("init --urdf ur5e.urdf --from cone.csv");
  EXPECT_EQ(asked.code, 1);
  EXPECT_THAT(asked.err, AllOf(HasSubstr("cone.csv: no three columns are called x, y, z"),
                               HasSubstr("--target with one of point, tool")));
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Touched, ALengthGoesWithWhatHasOne) {
  for (const auto& [words, says] : std::map<std::string, std::string>{
           {"--target point --length 0.05", "point has no length"},
           {"--target bar --length -1", "-1 is no length in metres"},
           {"--target sockets", "no column says which socket"},
           {"--target sockets --length 0.05", "no column is called 'socket'"}}) {
    fs::remove(folder_ / "columns.yaml");
    const Outcome refused = kinecal("init --urdf ur5e.urdf --from cone.csv " + words);
    EXPECT_EQ(refused.code, 1) << words;
    EXPECT_THAT(refused.err, HasSubstr(says)) << words;
    EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml")) << words;
  }
}

/// The tool's centre point as pendants find it, from four poses: the joints stay.
TEST_F(Touched, FourPosesGiveTheToolsCenterPoint) {
  const std::string table = read("cone.csv");
  std::size_t end = 0;
  for (int line = 0; line < 7; ++line) end = table.find('\n', end) + 1;
  write("cone.csv", table.substr(0, end));
  ASSERT_EQ(kinecal("init --urdf ur5e.urdf --from cone.csv --target tool --arm tool0").code, 0);
  EXPECT_THAT(read("calibrate.yaml"), Not(HasSubstr("free_params:")));
  ASSERT_EQ(kinecal("convert cone.csv samples.yaml --columns columns.yaml").code, 0);
  const Outcome done = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output out");
  EXPECT_THAT(done.out, HasSubstr("tip_z"));
}

/// How many poses it takes, before anybody has taken one; the tip is where the URDF has it.
TEST_F(Touched, PlansPosesInWhichTheTipTouches) {
  for (const auto& [target, tip] : std::map<std::string, std::string>{
           {"point", "tip"}, {"plane", "tip"}, {"distance", "gauge"}}) {
    ASSERT_EQ(kinecal("init --urdf ur5e.urdf --arm tool0 --force --target " + target).code, 0);
    const Outcome planned = kinecal("plan --urdf ur5e.urdf --config calibrate.yaml --accuracy '" +
                                    tip + " 1 mm' -o poses.yaml --force");
    EXPECT_EQ(planned.code, 0) << target << planned.out << planned.err;
    EXPECT_TRUE(fs::exists(folder_ / "poses.yaml")) << planned.out;
  }
}

/// A Panda with a ball in two sockets 50 mm apart, as a table with joints and sockets; two regions held out.
TEST_F(Touched, SocketsAndALengthFindTheGeometryOfThePanda) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const std::string data = test::data_folder().string() + "/mukca_panda/";
  Diagnostics diagnostics;
  std::string table = "socket";
  for (int i = 1; i <= 7; ++i) table += fmt::format(",panda_joint{}", i);
  for (const Sample& sample : read_samples(data + "panda_6/front.yaml", diagnostics)) {
    table += sample.observations.at(1).features.at(0).point.x() > 0.01 ? "\nB" : "\nA";
    for (int i = 1; i <= 7; ++i) {
      table += fmt::format(",{:.17g}", *sample.position(fmt::format("panda_joint{}", i)));
    }
  }
  write("front.csv", table + "\n");
  const std::string urdf = "--urdf " + data + "panda.urdf ";
  const Outcome made =
      kinecal("init " + urdf + "--from front.csv --length 0.05 --target-frame ball_link");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("from the samples: target sockets"));
  ASSERT_EQ(kinecal("convert front.csv samples.yaml --columns columns.yaml").code, 0);
  const std::string files = urdf + "--samples samples.yaml ";
  ASSERT_EQ(kinecal("identify " + files + "--config calibrate.yaml --geometry-only").code, 0);
  const Outcome done =
      kinecal("calibrate " + files + "--config identified.yaml --offsets origin --output out");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  for (const auto& [region, most] :
       std::map<std::string, double>{{"left", 0.265}, {"right", 0.307}}) {
    const Outcome held_out =
        kinecal("calibrate --urdf out/calibrated.urdf --config " + data + "panda_6/" + region +
                "_fixture.yaml --samples " + data + "panda_6/" + region + ".yaml --output " +
                region + " --report " + region + ".json");
    ASSERT_EQ(held_out.code, 0) << held_out.err;
    const auto report = nlohmann::json::parse(read(region + ".json"));
    const auto& step = report.at("steps").at(0);
    const double rms = 1e3 * std::sqrt(6.0 * step.at("final_cost").get<double>() /
                                       step.at("num_residuals").get<double>());
    std::cout << fmt::format("{} held out: {:.3f} mm\n", region, rms);
    EXPECT_LE(rms, most) << region;
  }
}

}  // namespace
}  // namespace kinecal
