// An error block of one's own with parameters and conditions, from YAML to the result.
#include "kinecal/config/registry.hpp"

#include <gmock/gmock.h>

#include "kinecal/config/register.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/calibrated.hpp"
#include "support/open_scene.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

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

}  // namespace
}  // namespace kinecal
