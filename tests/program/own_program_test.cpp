// A program with a sensor and an error block of its own, as its users meet it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kShoulder = 0.02, kOwnElbow = -0.03, kScale = 0.015, kZero = 0.06, kHook = 0.012;

const char* const kOwnUrdf = R"(<robot name="arm">
  <link name="base"/><link name="upper"/><link name="hand"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0.1 0 0.5"/><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.4 0 0"/><parent link="upper"/><child link="hand"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
</robot>
)";

const std::string kOwnConfig = R"(base_link: base
models:
 - {name: arm, type: chain3d, frame: hand}
 - {name: wire, type: draw_wire, frame: base}
free_params: [shoulder, elbow, wire_scale, wire_zero]
error_blocks:
 - {name: length, type: wire_length, model: arm, wire: wire, hook: 0.012, sigma: 0.001}
)";

class OwnProgram : public test::ProgramTest {
 protected:
  OwnProgram() {
    write("arm.urdf", kOwnUrdf);
    write("calibrate.yaml", kOwnConfig);
    const Robot robot = parse_urdf(kOwnUrdf, "arm.urdf");
    const RuntimeChain arm = make_chain(robot, "base", "hand");
    const Vector3<double> point(0.3, 0.05, 0.02);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-1.5, 1.5);
    std::vector<Sample> samples;
    for (int n = 0; n < 30; ++n) {
      Sample sample{{"shoulder", "elbow"}, {angle(random), angle(random)}, {}, ""};
      const auto true_position = [&](const std::string& joint) {
        return *sample.position(joint) + (joint == "elbow" ? kOwnElbow : kShoulder);
      };
      const double length = (forward_kinematics(arm, true_position) * point).norm() - kHook;
      sample.observations = {{"arm", {{"hand", point}}},
                             {"wire", {{"base", {(length - kZero) / (1.0 + kScale), 0, 0}}}}};
      samples.push_back(sample);
    }
    std::ofstream out(folder_ / "samples.yaml");
    write_samples(out, samples);
  }

  [[nodiscard]] test::Outcome calibrate() const {
    return run(test::own_program() +
               " calibrate --urdf arm.urdf --config calibrate.yaml --samples samples.yaml "
               "--output result");
  }
  void expect_refused(const std::string& config, const std::string& message) {
    write("calibrate.yaml", config);
    const test::Outcome result = calibrate();
    EXPECT_EQ(result.code, 1) << result.out;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(folder_ / "result"));
  }
  /// The configuration with one piece replaced.
  [[nodiscard]] static std::string with(const std::string& piece, const std::string& by) {
    std::string text = kOwnConfig;
    return text.replace(text.find(piece), piece.size(), by);
  }
};

TEST_F(OwnProgram, CalibratesWithASensorAndABlockOfItsOwn) {
  const test::Outcome result = calibrate();
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("wire_scale"));
  const YAML::Node values = YAML::Load(read("result/calibration.yaml"));
  EXPECT_NEAR(values["shoulder"].as<double>(), kShoulder, 1e-9);
  EXPECT_NEAR(values["elbow"].as<double>(), kOwnElbow, 1e-9);
  EXPECT_NEAR(values["wire_scale"].as<double>(), kScale, 1e-9);
  EXPECT_NEAR(values["wire_zero"].as<double>(), kZero, 1e-9);
}

TEST_F(OwnProgram, RefusesWhatItsTypesDoNotHave) {
  expect_refused(with("hook: 0.012", "hock: 0.012"), "calibrate.yaml:7: ");
  expect_refused(with("hook: 0.012", "hook: long"), "calibrate.yaml:7: ");
  expect_refused(with("sigma: 0.001", "sigma: 0.001, tension: 3"),
                 "calibrate.yaml:7: error block 'length': unknown key 'tension'");
  expect_refused(with("type: draw_wire", "type: draw_wir"), "did you mean 'draw_wire'?");
  expect_refused(with("type: wire_length", "type: wire_lenght"), "did you mean 'wire_length'?");
  expect_refused(with("wire_scale", "wire_scal"), "did you mean 'wire_scale'?");
  expect_refused(with("wire: wire", "wire: arm"),
                 "wire 'arm' is a chain3d; it must be a draw_wire, which observes readings");
  expect_refused(with("hook: 0.012", "hook: -1"),
                 "calibrate.yaml:7: error block 'length': the hook");
}

TEST_F(OwnProgram, KnowsItsTypesOnly) {
  const test::Outcome result =
      run(test::kinecal_program() + " check --urdf arm.urdf --config calibrate.yaml");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("type 'draw_wire' is not a model"));
}

}  // namespace
}  // namespace kinecal
