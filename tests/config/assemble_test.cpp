// What a configuration names and this calibration does not need, and names that differ.
#include "kinecal/config/assemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/sensors/built_in_sensor.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::Scenario;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A board on the table and a camera in the hand, with more in the configuration.
class Assemble : public testing::Test {
 protected:
  using Changes = std::vector<std::pair<std::string, std::string>>;
  /// @param changes  texts of the configuration that are replaced
  Diagnostics assembled(const Changes& changes = {}) {
    std::string text = test::kBoardConfig;
    text.replace(text.find("HOLDER"), 6, "base_link");
    for (const auto& [from, to] : changes) text.replace(text.find(from), from.size(), to);
    scenario_.config = test::config_of(text);
    Diagnostics found;
    calibration_ = assemble(scenario_.config, scenario_.robot, scenario_.samples, found);
    return found;
  }
  Diagnostics assembled(const std::string& from, const std::string& to) {
    return assembled({{from, to}});
  }
  Diagnostics with_block(const std::string& block) {
    return assembled("error_blocks:\n", "error_blocks:\n - {" + block + "}\n");
  }
  static constexpr const char* kBoardFree =
      " - {name: board, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\n";

  Scenario scenario_ = test::board_scenario(true, 1, 3);
  Calibration calibration_;
};

TEST_F(Assemble, APriorOnWhatIsNotFreeHasNoEffect) {
  for (const char* param : {"turn_z", "slide_x", "hand", "turn_x_gear_ratio", "slide_x_z"}) {
    const Diagnostics found =
        with_block("name: keep, type: outrageous, mean: 0, param: " + std::string(param));
    EXPECT_THAT(found.errors, IsEmpty()) << param;
    EXPECT_THAT(found.warnings, ElementsAre(AllOf(HasSubstr("error block 'keep' has no effect"),
                                                  HasSubstr(param))));
    EXPECT_THAT(calibration_.steps.at(0).problem->priors(), IsEmpty());
  }
}

/// Two components of a rotation vector are not two angles; of a plane that is touched, the third one has no effect.
TEST_F(Assemble, TwoOfThreeRotationsOfAJointAreAcceptedWithAWarning) {
  const auto with = [&](const std::string& axes) {
    return assembled("free_frames:\n", "free_frames:\n - {name: turn_z, " + axes + "}\n");
  };
  const Diagnostics two = with("roll: true, yaw: true");
  EXPECT_THAT(two.errors, IsEmpty());
  EXPECT_THAT(two.warnings, ElementsAre(HasSubstr(
                                "free frame 'turn_z': roll and yaw are free and pitch is not: the "
                                "free parameters are two components of a rotation vector")));
  EXPECT_THAT(with("roll: true").warnings, IsEmpty());
  EXPECT_THAT(with("roll: true, pitch: true, yaw: true").warnings, IsEmpty());
  EXPECT_THAT(assembled(kBoardFree, " - {name: board, x: true, roll: true, yaw: true}\n").warnings,
              IsEmpty());
}

TEST_F(Assemble, APriorOnATargetThatIsNotFreeHasNoEffect) {
  const Diagnostics found = assembled({{kBoardFree, "fixed_frames:\n - {name: board, x: 0.1}\n"},
                                       {"error_blocks:\n",
                                        "error_blocks:\n - {name: keep, type: outrageous, param: "
                                        "board}\n"}});
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("error block 'keep' has no effect")));
}

TEST_F(Assemble, APriorOnANameThatTheRobotDoesNotHaveIsAnError) {
  EXPECT_THAT(with_block("name: keep, type: outrageous, param: turn_w").errors,
              ElementsAre(AllOf(HasSubstr("error block 'keep': param 'turn_w' is not a free joint"),
                                HasSubstr("did you mean 'turn_"))));
  EXPECT_THAT(with_block("name: keep, type: outrageous, param: gripper_finger").errors,
              ElementsAre(HasSubstr("param 'gripper_finger' is not")));
}

TEST_F(Assemble, AnInitialValueOfAFrameThatIsNotFreeHasNoEffect) {
  const auto initial = [&](const std::string& frame) {
    return assembled("error_blocks:", "free_frames_initial_values:\n - {name: " + frame +
                                          ", x: 0.1}\nerror_blocks:");
  };
  for (const char* frame : {"slide_x", "pallet"}) {
    const Diagnostics found = initial(frame);
    EXPECT_THAT(found.errors, IsEmpty());
    EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("'" + std::string(frame) +
                                                      "' has no effect: the frame is not free")));
  }
  EXPECT_THAT(initial("bord").errors,
              ElementsAre(HasSubstr("initial value of free frame 'bord': there is no such free "
                                    "frame; did you mean 'board'?")));
}

TEST_F(Assemble, AModelThatNoBlockUsesMayBeWrong) {
  const auto model = [&](const std::string& text) {
    return assembled("free_params", " - {" + text + "}\nfree_params");
  };
  const Diagnostics link = model("name: head, type: chain, frame: neck");
  EXPECT_THAT(link.errors, IsEmpty());
  EXPECT_THAT(link.warnings, ElementsAre(AllOf(HasSubstr("model 'head': no link 'neck'"),
                                               HasSubstr("no error block uses the model"))));
  const Diagnostics fitting = model("name: head, type: chain, frame: pitch");
  EXPECT_THAT(fitting.errors, IsEmpty());
  EXPECT_THAT(fitting.warnings, IsEmpty());
}

TEST_F(Assemble, AFixedJointInTheListOfJointsHasNoEffect) {
  const Diagnostics found = assembled("[turn_y,", "[turn_y, bracket,");
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("joint 'bracket' is fixed and has no offset")));
}

TEST_F(Assemble, FramesMayHaveALeadingSlash) {
  for (Sample& sample : scenario_.samples) {
    for (Feature& feature : sample.observations[1].features) feature.frame = "/camera";
  }
  const Diagnostics found = assembled(kBoardFree,
                                      " - {name: /board, x: true, y: true, z: true, roll: true, "
                                      "pitch: true, yaw: true}\n");
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.warnings, IsEmpty());
  EXPECT_GE(calibration_.table.find("/board_x"), 0) << "as the configuration spells it";
  for (const char* link : {"camera", "/camera"}) {
    EXPECT_THAT(assembled("frame: camera", "frame: " + std::string(link)).errors, IsEmpty());
  }
  EXPECT_THAT(assembled("base_link: base_link", "base_link: /base_link").errors, IsEmpty());
  EXPECT_EQ(calibration_.steps.at(0).problem->base(), "base_link");
}

TEST_F(Assemble, NamesThatDifferAreOneErrorWithTheLikelyOne) {
  for (Sample& sample : scenario_.samples) sample.observations[0].sensor = "arm";
  const Diagnostics found = assembled();
  EXPECT_THAT(found.warnings, IsEmpty());
  EXPECT_THAT(found.errors,
              ElementsAre(AllOf(HasSubstr("model 'board_holder': no sample has a sensor of that "
                                          "name; did you mean 'arm'?"),
                                HasSubstr("chain_sensor_name in capture.yaml"))));
  for (Sample& sample : scenario_.samples) sample.observations[1].sensor = "lens";
  EXPECT_THAT(assembled().errors,
              ElementsAre(HasSubstr("models 'board_holder' and 'eye': no sample has sensors of "
                                    "these names; the samples have 'arm' and 'lens'")));
}

TEST_F(Assemble, AModelWithoutSamplesIsOneWarningWithWhatFollows) {
  const Diagnostics found =
      assembled({{"free_params: [",
                  " - {name: laser, type: camera3d, frame: hand}\n"
                  "free_params: [laser_z_offset, "},
                 {"error_blocks:\n",
                  "error_blocks:\n - {name: ground, type: chain3d_to_plane, model: laser}\n"}});
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.warnings,
              ElementsAre(AllOf(HasSubstr("model 'laser': no sample has a sensor of that name"),
                                HasSubstr("so 'ground' has no samples, and 'laser_z_offset' keeps "
                                          "its initial value"))));
}

TEST_F(Assemble, SamplesThatAreWrongAlikeAreOneError) {
  for (Sample& sample : scenario_.samples) {
    for (Feature& feature : sample.observations[1].features) feature.frame = "lens";
  }
  EXPECT_THAT(assembled().errors,
              ElementsAre(AllOf(HasSubstr("board:0: sensor 'eye': a feature is in frame 'lens'"),
                                HasSubstr("(and in 2 more samples)"))));
}

TEST_F(Assemble, OtherSamplesOfWhatIsAssembledAreAsAssembledAnew) {
  ASSERT_THAT(assembled().errors, IsEmpty());
  const Calibration first = std::move(calibration_);
  for (Sample& sample : scenario_.samples) sample.joint_positions.front() += 0.02;
  ASSERT_THAT(assembled().errors, IsEmpty());
  const Eigen::VectorXd expected = calibrate(calibration_).table.values();
  const auto differs = [&](const Calibration& other) {
    return (calibrate(other).table.values() - expected).norm();
  };
  // The search for poses may take other samples, and so begin elsewhere.
  EXPECT_LT(differs(with_samples(first, scenario_.samples)), 1e-7);
  EXPECT_GT(differs(first), 1e-3);
  scenario_.samples.pop_back();
  EXPECT_THROW((void)with_samples(first, scenario_.samples), std::invalid_argument);
}

TEST_F(Assemble, WhatIsUndeterminedDoesNotAffectTheCost) {
  ASSERT_THAT(assembled().errors, IsEmpty());
  for (Sample& sample : scenario_.samples) sample.joint_positions.front() += 0.02;
  const Calibration moved = with_samples(calibration_, scenario_.samples);
  const auto cost = [](const CalibrationResult& result) { return result.steps.back().final_cost; };
  const double held = cost(calibrate(moved));
  EXPECT_NEAR(cost(calibrate(moved, {}, {.hold_undetermined = false})), held, 1e-9 * held + 1e-15);
}

}  // namespace
}  // namespace kinecal
