// The programs of examples/robots as their users meet them, against the program that reads a
// configuration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kRobots = test::source_folder() + "/examples/robots/";

/// One sums in an order of its own, and another instruction set has other lanes.
constexpr double kSameNumbers = 1e-10;

/// The same for parameters, in radians, meters and by value for pixels: the samples leave two
/// directions open (the pan joints against each other, for one), and along these rounding alone
/// decides where a solve stops, some 1e-8 apart from machine to machine.
constexpr double kAlongOpenDirections = 1e-6;
[[nodiscard]] double tolerance(double value) {
  return kAlongOpenDirections * std::max(1.0, std::abs(value));
}

class RobotProgram : public test::ProgramTest {
 protected:
  [[nodiscard]] YAML::Node report(const std::string& folder) const {
    return YAML::LoadFile((folder_ / folder / "report.json").string());
  }
  [[nodiscard]] std::set<std::string> files(const std::string& folder) const {
    std::set<std::string> names;
    for (const auto& file : fs::directory_iterator(folder_ / folder)) {
      names.insert(file.path().filename());
    }
    return names;
  }
};

/// Texts that differ in nothing but numbers, and these only within tolerance().
void expect_same_text(const std::string& a, const std::string& b) {
  const char *x = a.c_str(), *y = b.c_str();
  while (*x != 0 && *y != 0) {
    char *x_end = nullptr, *y_end = nullptr;
    const double x_number = std::strtod(x, &x_end), y_number = std::strtod(y, &y_end);
    const bool are_numbers = x_end != x && y_end != y;
    if (are_numbers) {
      ASSERT_NEAR(x_number, y_number, tolerance(y_number))
          << "at \"" << std::string(x).substr(0, 40) << "\"";
    } else {
      ASSERT_EQ(*x, *y) << "at \"" << std::string(x).substr(0, 40) << "\"";
    }
    x = are_numbers ? x_end : x + 1;
    y = are_numbers ? y_end : y + 1;
  }
  EXPECT_EQ(std::string(x), std::string(y));
}

std::map<std::string, double> parameters(const YAML::Node& report) {
  std::map<std::string, double> values;
  for (const YAML::Node& p : report["parameters"]) {
    values[p["name"].as<std::string>()] = p["value"].as<double>();
  }
  return values;
}

TEST_F(RobotProgram, FetchsCrateSolvesWhatItsConfigurationSays) {
  const test::Outcome drawn =
      run(test::program("calibrate_fetch") + " --write-samples drawn.yaml --output a");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  const test::Outcome crate =
      run(test::program("calibrate_fetch") + " --samples drawn.yaml --output crate");
  ASSERT_EQ(crate.code, 0) << crate.err;
  const test::Outcome configured =
      run(test::kinecal_program() + " calibrate --urdf " + kRobots + "fetch/fetch.urdf --config " +
          kRobots + "fetch/calibrate.yaml --samples drawn.yaml --output configured");
  ASSERT_EQ(configured.code, 0) << configured.err;

  for (const char* cost : {"initial_cost", "final_cost"}) {
    const auto expected = report("configured")["steps"][0][cost].as<double>();
    EXPECT_NEAR(report("crate")["steps"][0][cost].as<double>(), expected, kSameNumbers * expected);
    EXPECT_EQ(report("crate")["steps"][0][cost].as<double>(),
              report("a")["steps"][0][cost].as<double>())
        << "a file changes no sample";
  }
  const auto expected = parameters(report("configured")), found = parameters(report("crate"));
  EXPECT_EQ(expected.size(), 26u);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_NEAR(found.at(name), value, tolerance(value)) << name;
  }
  auto of_crate = files("crate");
  of_crate.insert({"original.urdf", "config.yaml"});  // a crate has no configuration to copy
  EXPECT_EQ(of_crate, files("configured"));
  for (const char* file : {"calibrated.urdf", "depth_camera.yaml", "rgb_camera.yaml"}) {
    SCOPED_TRACE(file);
    expect_same_text(read("crate/" + std::string(file)), read("configured/" + std::string(file)));
  }
}

/// One joint of every tenth sample is elsewhere than it says.
/// @returns  their numbers, from 1
std::set<int> ruin(const fs::path& file) {
  std::vector<YAML::Node> samples = YAML::LoadAllFromFile(file.string());
  std::set<int> ruined;
  std::ofstream out(file);
  out.precision(17);
  int number = 0;
  for (YAML::Node& sample : samples) {
    if (++number % 10 == 4) {
      YAML::Node position = sample["joint_states"]["position"][2];
      position = position.as<double>() + 0.05;
      ruined.insert(number);
    }
    out << sample << "\n---\n";
  }
  return ruined;
}

/// The numbers of the samples that a result left out.
std::set<int> left_out(const YAML::Node& report) {
  std::set<int> numbers;
  for (const YAML::Node& sample : report["left_out"]) numbers.insert(sample["sample"].as<int>());
  return numbers;
}

TEST_F(RobotProgram, PandasCrateNamesTheRuinedSamplesAsTheProgramDoes) {
  const std::string panda = test::program("calibrate_panda");
  ASSERT_EQ(run(panda + " --write-samples drawn.yaml").code, 0);
  const std::set<int> ruined = ruin(folder_ / "drawn.yaml");
  ASSERT_EQ(ruined.size(), 10u);
  const test::Outcome crate = run(panda + " --samples drawn.yaml --output crate");
  ASSERT_EQ(crate.code, 0) << crate.out << crate.err;
  const test::Outcome configured =
      run(test::kinecal_program() + " calibrate --urdf " + kRobots + "panda/panda.urdf --config " +
          kRobots + "panda/calibrate.yaml --samples drawn.yaml --output configured");
  ASSERT_EQ(configured.code, 0) << configured.out << configured.err;
  EXPECT_EQ(left_out(report("crate")), ruined);
  EXPECT_EQ(left_out(report("configured")), ruined);
  EXPECT_EQ(report("crate")["verdict"].as<std::string>(),
            report("configured")["verdict"].as<std::string>());
  const auto parameters_of = [](const YAML::Node& report) {
    std::map<std::string, std::pair<double, double>> all;
    for (const YAML::Node& p : report["parameters"]) {
      all[p["name"].as<std::string>()] = {p["value"].as<double>(), p["sigma"].as<double>()};
    }
    return all;
  };
  const auto expected = parameters_of(report("configured")), found = parameters_of(report("crate"));
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, of] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_NEAR(found.at(name).first, of.first, tolerance(of.first)) << name;
    EXPECT_NEAR(found.at(name).second, of.second, 1e-6 * of.second) << name;
  }
}

TEST_F(RobotProgram, ReportsWhatItFoundOnSamplesHeldOut) {
  const test::Outcome result =
      run(test::program("calibrate_fetch") + " --pairs 40 --planes 10 --seed 3");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("On samples held out"));
  EXPECT_THAT(result.out, HasSubstr("2 of 26 parameters cannot be determined"));
}

TEST_F(RobotProgram, ExitsWith2WhereHeldOutSamplesShowMoreThanNoise) {
  const test::Outcome result = run(test::program("calibrate_fetch") + " --pairs 6 --planes 3");
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.err, HasSubstr("samples that were held out show more than noise"));
}

TEST_F(RobotProgram, RefusesSamplesThatAreNotThere) {
  const test::Outcome result =
      run(test::program("calibrate_fetch") + " --samples none.yaml --output out");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("none.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace kinecal
