// An error block with parameters and conditions, and a lens, of a user's own, from YAML to the result.
#include "kinecal/config/registry.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/register.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/calibrated.hpp"
#include "support/division_lens.hpp"
#include "support/open_scene.hpp"
#include "support/temporary_folder.hpp"
#include "support/wheels.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// A base that drives: its sample before this one is in each sample.
TEST(RegisteredBlockWithoutSensor, CalibratesFromYaml) {
  if (registry().block("wheels") == nullptr) register_block<test::Wheels>({});
  Diagnostics found;
  CalibrationSetup setup{
      .robot = test::mobile_manipulator(),
      .config =
          parse_config("base_link: base_link\nmodels: []\nfree_params: [base_left, base_right, "
                       "base_track]\nerror_blocks:\n- {name: base, type: wheels}\n",
                       "c.yaml", found)};
  EXPECT_THAT(found.errors, testing::IsEmpty());
  double left = 0.0, right = 0.0;
  for (int n = 0; n < 40; ++n) {
    const double by_left = 1.0 + std::sin(n), by_right = 1.0 + std::cos(2.0 * n);
    left += by_left;
    right += by_right;
    Sample& sample = setup.samples.emplace_back();
    sample.joint_names = {"wheel_left", "wheel_right"};
    sample.joint_positions = {left, right};
    const double noise = 1e-4 * std::sin(7.0 * n);  // metres
    sample.conditions = {{"way", 0.5 * (0.102 * by_left + 0.0985 * by_right) + noise},
                         {"turn", (0.0985 * by_right - 0.102 * by_left) / 0.53 - noise}};
  }
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup));
  ASSERT_TRUE(calibrated.result.converged);
  EXPECT_NEAR(calibrated.result.table["base_left"].value, 0.102, 1e-4);
  EXPECT_NEAR(calibrated.result.table["base_right"].value, 0.0985, 1e-4);
  EXPECT_NEAR(calibrated.result.table["base_track"].value, 0.53, 1e-3);
}

class RegisteredBlock : public test::FolderTest {
 protected:
  RegisteredBlock() {
    if (registry().block("thermal_bar") == nullptr) {
      register_block<test::ThermalBar>(
          {{"model_a"}, {"model_b"}}, {{"bend", 0.0}},
          [](const BlockNumbers& numbers) { return test::ThermalBar{numbers.at("bend")}; });
    }
    write("c.yaml", R"(base_link: base_link
models:
 - {name: arm, type: chain3d, frame: hand}
 - {name: forearm, type: chain3d, frame: forearm}
free_params: [bar_length, bar_expansion]
error_blocks:
 - {name: bar, type: thermal_bar, model_a: arm, model_b: forearm, bend: 0.001, sigma: 0.0001}
)");
  }
  /// A bar of 0.5 m (1 + 0.003 (T - 20)) that lies along x of the hand.
  [[nodiscard]] std::vector<Sample> samples() const {
    const Robot robot = test::mobile_manipulator();
    const RuntimeChain wrist = make_chain(robot, "forearm", "hand");
    std::vector<Sample> all;
    for (int n = 0; n < 12; ++n) {
      Sample& sample = all.emplace_back();
      for (const Joint& joint : robot.joints()) {
        if (!moves(joint.type) || joint.mimic) continue;
        sample.joint_names.push_back(joint.name);
        sample.joint_positions.push_back(0.1 * n);
      }
      sample.conditions = {{"temperature", 12.5 + 2.0 * n}, {"load", 3.0 - 0.5 * n}};
      const double length = 0.5 * (1.0 + 0.003 * (sample.conditions["temperature"] - 20.0)) -
                            0.001 * sample.conditions["load"];
      const Pose<double> forearm_T_hand = forward_kinematics(
          wrist, [&](const std::string& joint) { return *sample.position(joint); });
      sample.observations = {
          {"arm", {{"hand", {0, 0, 0}}}},
          {"forearm", {{"forearm", forearm_T_hand * Vector3<double>(length, 0, 0)}}}};
    }
    return all;
  }
  [[nodiscard]] test::Calibrated calibrated(const std::vector<Sample>& recorded) const {
    std::ofstream(folder_ / "s.yaml") << [&] {
      std::ostringstream out;
      write_samples(out, recorded);
      return out.str();
    }();
    Diagnostics diagnostics;
    std::vector<Sample> read = read_samples((folder_ / "s.yaml").string(), diagnostics);
    diagnostics.throw_if_errors();
    return test::calibrate_samples(test::mobile_manipulator(), folder_ / "c.yaml", std::move(read));
  }
};

TEST_F(RegisteredBlock, FindsItsParametersFromConditionsInYaml) {
  const test::Calibrated found = calibrated(samples());
  EXPECT_NEAR(found.result.table["bar_length"].value, 0.5, 1e-9);
  EXPECT_NEAR(found.result.table["bar_expansion"].value, 0.003, 1e-9);
}

TEST_F(RegisteredBlock, NamesASampleWithoutAConditionOfIt) {
  std::vector<Sample> recorded = samples();
  recorded[1].conditions.erase("load");
  try {
    (void)calibrated(recorded);
    FAIL() << "the load is missing";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("s.yaml:"));
    EXPECT_THAT(e.what(), HasSubstr("error block 'bar': condition 'load' is not in the sample"));
  }
}

class RegisteredLens : public test::FolderTest {
 protected:
  using Camera = LensCamera<test::Division>;
  static constexpr double kRecorded = -0.05, kTrue = -0.12;

  RegisteredLens() {
    const auto& lenses = registry().sensor("camera2d")->lenses;
    if (std::find(lenses.begin(), lenses.end(), "division") == lenses.end()) {
      register_sensor(Camera{});
    }
  }
  void write_config(const std::string& lens) {
    write("c.yaml", R"(base_link: base_link
models:
 - {name: arm, type: chain3d, frame: hand}
 - {name: eye, type: camera2d, frame: camera_optical_frame)" +
                        lens + R"(}
free_params: [eye_fx, eye_k]
error_blocks:
 - {name: pixels, type: chain3d_to_camera2d, model_3d: arm, model_2d: eye, sigma: 0.1}
)");
  }
  /// What a camera of this lens sees of points of the hand.
  [[nodiscard]] static std::vector<Sample> samples() {
    const Robot robot = test::mobile_manipulator();
    const RuntimeChain hand = make_chain(robot, "base_link", "hand"),
                       eye = make_chain(robot, "base_link", "camera_optical_frame");
    CameraInfo info;
    info.width = 640;
    info.height = 480;
    info.k = {500, 0, 320, 0, 500, 240, 0, 0, 1};
    info.distortion_model = "division";
    info.d = {kRecorded};
    std::vector<Sample> all;
    for (int n = 0; n < 8; ++n) {
      Sample& sample = all.emplace_back();
      for (const Joint& joint : robot.joints()) {
        if (!moves(joint.type) || joint.mimic) continue;
        sample.joint_names.push_back(joint.name);
        sample.joint_positions.push_back(0.05 * n);
      }
      const auto position = [&](const std::string& joint) { return *sample.position(joint); };
      const Pose<double> hand_T_eye =
          forward_kinematics(hand, position).inverse() * forward_kinematics(eye, position);
      Observation arm{"arm", {}}, seen{"eye", {}, info};
      for (const Vector3<double>& p :
           {Vector3<double>(-0.3, 0.1, 0.6), Vector3<double>(0.05 * n, -0.2, 0.7)}) {
        const auto pixel = Camera{}.predict(p, Camera{}.settings(seen),
                                            Camera::Settings{0.02, 0, 0, 0, kTrue - kRecorded});
        arm.features.push_back({"hand", hand_T_eye * p});
        seen.features.push_back({"camera_optical_frame", {pixel.x(), pixel.y(), 0.0}});
      }
      sample.observations = {arm, seen};
    }
    return all;
  }
};

TEST_F(RegisteredLens, IsCalibratedFromYaml) {
  write_config(", lens: division");
  const test::Calibrated found =
      test::calibrate_samples(test::mobile_manipulator(), folder_ / "c.yaml", samples());
  EXPECT_NEAR(found.result.table["eye_fx"].value, 0.02, 1e-9);
  EXPECT_NEAR(found.result.table["eye_k"].value, kTrue - kRecorded, 1e-9);
}

TEST_F(RegisteredLens, IsTakenFromCameraInfoIfTheConfigurationNamesNone) {
  write_config("");
  Diagnostics diagnostics;
  Config config = read_config((folder_ / "c.yaml").string(), diagnostics);
  std::vector<Sample> recorded = samples();
  choose_lenses(config, recorded, diagnostics);
  EXPECT_TRUE(diagnostics.errors.empty());
  EXPECT_EQ(config.steps.front().models.back().lens, "division");
}

TEST_F(RegisteredLens, IsNamedAmongTheLensesAndTakenOnce) {
  write_config(", lens: divison");
  Diagnostics diagnostics;
  (void)read_config((folder_ / "c.yaml").string(), diagnostics);
  EXPECT_THAT(diagnostics.errors, testing::Contains(HasSubstr("did you mean 'division'?")));
  EXPECT_THROW(register_sensor(Camera{}), std::invalid_argument);
  EXPECT_THROW(register_sensor(LensCamera<Equidistant>{}), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
