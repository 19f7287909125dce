#include "kinecal/tools/install/stored_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/arm_scene.hpp"
#include "support/launch_scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class ReadResult : public test::InstallScene {
 protected:
  ReadResult() {
    write("out/original.urdf", test::kArmUrdf);
    write("out/config.yaml", test::kArmConfig);
    write("out/report.json", R"({
      "format": 2, "converged": true, "verdict": "use with care",
      "parameters": [{"name": "elbow", "unit": "rad", "value": 0.02, "sigma": 0.001},
                     {"name": "camera_z_scaling", "unit": "1", "value": 0.01}],
      "covariance": {"parameters": ["elbow"], "lower": [[1e-6]],
                     "undetermined": [{"camera_z_scaling": 1.0}]},
      "noise": [{"name": "hand_eye", "unit": "m", "features": 4, "components": 3, "freedom": 9,
                 "sigma": 0.5, "held_out": 0.75}],
      "error_blocks": [{"name": "hand_eye", "after": {"rms": 2.0}}],
      "poses": {"joints": ["elbow"], "positions": [[0.5], [0.25]]},
      "images": {}
    })");
  }
  [[nodiscard]] StoredResult result() const { return read_result((folder_ / "out").string()); }
  [[nodiscard]] std::string refusal() const {
    return test::thrown<InputError>([&] { (void)result(); }, "");
  }
};

TEST_F(ReadResult, HasWhatTheReportAndTheFilesBesideItSay) {
  const StoredResult read = result();
  EXPECT_EQ(read.verdict, "use with care");
  EXPECT_EQ(read.values.at("elbow"), 0.02);
  EXPECT_EQ(read.deviations.at("elbow"), 0.001);
  EXPECT_TRUE(std::isinf(read.deviations.at("camera_z_scaling")));
  EXPECT_THAT(read.covariance, ElementsAre(ElementsAre(1e-6)));
  EXPECT_EQ(read.noise.at(0).sigma, 0.5);
  EXPECT_EQ(read.fitted.at("hand_eye").distance, 2.0);
  EXPECT_EQ(read.fitted.at("hand_eye").held_out, 0.75);
  EXPECT_EQ(read.pose_samples().at(1).joint_positions.at(0), 0.25);
  EXPECT_EQ(read.urdf_text, test::kArmUrdf);
  EXPECT_FALSE(read.pose);
}

TEST_F(ReadResult, HasTheParametersOfATableByIndex) {
  ParameterTable table;
  table.add({.name = "camera_z_scaling"});
  table.add({.name = "shoulder"});
  EXPECT_THAT(result().values_of(table), ElementsAre(0.01, 0.0));
  EXPECT_THROW((void)result().state(table), InputError);  // lacks elbow
  table.add({.name = "elbow"});
  const CalibratedState state = result().state(table);
  EXPECT_THAT(state.parameters, ElementsAre(2));
  EXPECT_EQ(state.covariance(0, 0), 1e-6);
}

TEST_F(ReadResult, IsRefusedIfItWasChangedOrMustNotBeUsed) {
  spoil("out/report.json", "\"value\": 0.02", "\"value\": 0.03");
  EXPECT_THAT(refusal(), HasSubstr("'elbow' is 0.02 there and 0.03 in report.json"));
  spoil("out/report.json", "use with care", "do not use");
  EXPECT_THAT(refusal(), HasSubstr("report.json: this result was judged 'do not use'"));
}

TEST_F(ReadResult, ReadsOlderFormatsAndRefusesNewerOnes) {
  spoil("out/report.json", "\"format\": 2, ", "");
  EXPECT_EQ(result().fitted.at("hand_eye").distance, std::sqrt(3.0) * 2.0) << "was of components";
  spoil("out/report.json", "\"converged\"", "\"format\": 3, \"converged\"");
  EXPECT_THAT(refusal(), HasSubstr("it has format 3, and this version of kinecal reads up to 2"));
}

TEST_F(ReadResult, IsRefusedIfSomethingIsMissing) {
  spoil("out/report.json", "\"poses\"", "\"poses of samples\"");
  EXPECT_THAT(refusal(), HasSubstr("poses"));
  EXPECT_THAT(refusal(), HasSubstr("; calibrate again with this version"));
  fs::remove(folder_ / "out/original.urdf");
  EXPECT_THAT(refusal(), HasSubstr("has no original.urdf, so it cannot be checked"));
  fs::remove_all(folder_ / "out");
  EXPECT_THAT(refusal(), HasSubstr("out: does not exist; give the folder"));
}

}  // namespace
}  // namespace kinecal
