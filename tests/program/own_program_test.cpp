// A program with a sensor and an error block of its own, as its users meet it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/text_file.hpp"
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
  <link name="base_link"/><link name="upper_arm_link"/><link name="gripper_link"/>
  <joint name="shoulder_lift_joint" type="revolute">
    <origin xyz="0.1 0 0.5"/><parent link="base_link"/><child link="upper_arm_link"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow_flex_joint" type="revolute">
    <origin xyz="0.4 0 0"/><parent link="upper_arm_link"/><child link="gripper_link"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
</robot>
)";

class OwnProgram : public test::ProgramTest {
 protected:
  OwnProgram() {
    write("arm.urdf", kOwnUrdf);
    write("calibrate.yaml", config_);
    const Robot robot = parse_urdf(kOwnUrdf, "arm.urdf");
    const RuntimeChain arm = make_chain(robot, "base_link", "gripper_link");
    const Vector3<double> point(0.3, 0.05, 0.02);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-1.5, 1.5);
    std::vector<Sample> samples;
    for (int n = 0; n < 30; ++n) {
      Sample sample{
          {"shoulder_lift_joint", "elbow_flex_joint"}, {angle(random), angle(random)}, {}, ""};
      const auto true_position = [&](const std::string& joint) {
        return *sample.position(joint) + (joint == "elbow_flex_joint" ? kOwnElbow : kShoulder);
      };
      const double length = (forward_kinematics(arm, true_position) * point).norm() - kHook;
      sample.observations = {{"arm", {{"gripper_link", point}}},
                             {"wire", {{"base_link", {(length - kZero) / (1.0 + kScale), 0, 0}}}}};
      samples.push_back(sample);
    }
    std::ofstream out(folder_ / "samples.yaml");
    write_samples(out, samples);
  }

  [[nodiscard]] test::Outcome calibrate() const {
    return run(test::program("own_kinecal") +
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
  [[nodiscard]] std::string with(const std::string& piece, const std::string& by) const {
    std::string text = config_;
    return text.replace(text.find(piece), piece.size(), by);
  }

  /// As it is shipped with the example.
  const std::string config_ =
      detail::read_text_file(test::source_folder() + "/examples/own_program/calibrate.yaml");
};

TEST_F(OwnProgram, CalibratesWithASensorAndABlockOfItsOwn) {
  const test::Outcome result = calibrate();
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("wire_scale"));
  const YAML::Node values = YAML::Load(read("result/calibration.yaml"));
  EXPECT_NEAR(values["shoulder_lift_joint"].as<double>(), kShoulder, 1e-9);
  EXPECT_NEAR(values["elbow_flex_joint"].as<double>(), kOwnElbow, 1e-9);
  EXPECT_NEAR(values["wire_scale"].as<double>(), kScale, 1e-9);
  EXPECT_NEAR(values["wire_zero"].as<double>(), kZero, 1e-9);
}

TEST_F(OwnProgram, RefusesWhatItsTypesDoNotHave) {
  expect_refused(with("hook: 0.012", "hock: 0.012"), "calibrate.yaml:8: ");
  expect_refused(with("hook: 0.012", "hook: long"), "calibrate.yaml:8: ");
  expect_refused(with("sigma: 0.0002", "sigma: 0.0002, tension: 3"),
                 "calibrate.yaml:8: error block 'length': unknown key 'tension'");
  expect_refused(with("type: draw_wire", "type: draw_wir"), "did you mean 'draw_wire'?");
  expect_refused(with("type: wire_length", "type: wire_lenght"), "did you mean 'wire_length'?");
  expect_refused(with("wire_scale", "wire_scal"), "did you mean 'wire_scale'?");
  expect_refused(with("wire: wire", "wire: arm"),
                 "wire 'arm' is a chain3d; it must be a draw_wire, which observes readings");
  expect_refused(with("hook: 0.012", "hook: -1"),
                 "calibrate.yaml:8: error block 'length': the hook");
}

TEST_F(OwnProgram, KnowsItsTypesOnly) {
  const test::Outcome result =
      run(test::kinecal_program() + " check --urdf arm.urdf --config calibrate.yaml");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("type 'draw_wire' is not a model"));
}

}  // namespace
}  // namespace kinecal
