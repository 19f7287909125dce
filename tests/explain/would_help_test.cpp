// What would make a calibration better: held parameters, and scales that lengths have absorbed.
#include "kinecal/explain/would_help.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/explain/explain_fit.hpp"
#include "kinecal/tools/identify/robot_search.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/spoiled_robot.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using test::assembled;
using test::find_errors;
using test::SpoiledRobot;

/// Sentences about a scale, of a calibration.
std::vector<std::string> scales_in(const Config& config, const Robot& robot,
                                   std::span<const Sample> samples) {
  Calibration calibration = assembled(config, robot, samples);
  const JudgedResult judged = calibrate_and_judge(calibration, samples);
  return wrong_scales(config, robot, samples, judged.result.table, judged.assessments.back());
}

/// Sentences about a scale, of the calibration that a search finds.
std::vector<std::string> scales_in(const SpoiledRobot& arm, std::span<const Sample> samples) {
  return scales_in(search_robot(arm.config(), arm.robot(), samples).config, arm.robot(), samples);
}

/// A configuration that holds the zeros and frees the places of some joints instead.
Config lengths_for_zeros(const SpoiledRobot& arm, const std::vector<std::string>& joints) {
  Config config = arm.config();
  std::erase_if(config.steps.front().free_params,
                [&](const FreeParamConfig& free) { return arm.robot().has_joint(free.name); });
  for (const std::string& joint : joints) {
    config.steps.front().free_frames.push_back(
        {joint, {true, true, true, false, false, false}, {}});
  }
  return config;
}

void scale_tracker(std::vector<Sample>& samples, double factor) {
  for (Sample& sample : samples) sample.observations[1].features[0].point *= factor;
}

TEST(Scales, AScaleIsNamedThatLengthsHaveAbsorbed) {
  SpoiledRobot arm(8);
  arm.spoil(0, "wrist_1_joint", 0.02);
  std::vector<Sample> samples = arm.samples();
  EXPECT_THAT(scales_in(arm, samples), IsEmpty());
  scale_tracker(samples, 1.02);
  EXPECT_THAT(scales_in(arm, samples),
              ElementsAre(AllOf(HasSubstr("with the points of 'tracker' multiplied by 0.980"),
                                HasSubstr(", the lengths of the robot change by "))));
}

TEST(Scales, AScaleIsNamedBesideWrongZeros) {
  SpoiledRobot arm(4);
  arm.spoil(0, "wrist_1_joint_z", 0.0015);
  std::vector<Sample> samples = arm.samples();
  for (Sample& sample : samples) {
    sample.joint_positions[1] -= 0.021;
    sample.joint_positions[2] += 0.014;
  }
  scale_tracker(samples, 1.02);
  const Config lengths =
      lengths_for_zeros(arm, {"elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"});
  EXPECT_THAT(scales_in(lengths, arm.robot(), samples),
              ElementsAre(AllOf(HasSubstr("with the points of 'tracker' multiplied by 0.98"),
                                HasSubstr(" falls from "), HasSubstr(" with zeros in place of "))));
}

/// What would help a calibration.
std::vector<std::string> helps_of(const Config& config, const Robot& robot,
                                  std::span<const Sample> samples) {
  const Calibration calibration = assembled(config, robot, samples);
  return would_help(config, robot, samples, calibration, calibrate(calibration)).sentences;
}

/// A robot with a wrong zero, and a configuration that holds it.
struct HeldZero {
  HeldZero() {
    arm.spoil(0, "wrist_2_joint", 0.02);
    config = arm.config();
    std::erase_if(config.steps.front().free_params,
                  [](const FreeParamConfig& free) { return free.name == "wrist_2_joint"; });
  }
  SpoiledRobot arm{11};
  Config config;
};

TEST(WouldHelp, NamesAHeldZeroAndWhatItBuys) {
  const HeldZero held;
  const auto helps = helps_of(held.config, held.arm.robot(), held.arm.samples());
  ASSERT_FALSE(helps.empty());
  EXPECT_THAT(helps.front(),
              testing::MatchesRegex("freeing wrist_2_joint lowers the error on held-out "
                                    "poses from [0-9.]+ mm to 0\\.1[0-9]+ mm"));
  EXPECT_THAT(helps_of(held.arm.config(), held.arm.robot(), held.arm.samples()), IsEmpty());
}

TEST(WouldHelp, CountsErrorsOfSeveralBlocksInTheirNoise) {
  HeldZero held;
  std::vector<BlockConfig>& blocks = held.config.steps.front().error_blocks;
  blocks.push_back(blocks.front());
  blocks.back().name = "again";
  const auto helps = helps_of(held.config, held.arm.robot(), held.arm.samples());
  ASSERT_FALSE(helps.empty());
  EXPECT_THAT(helps.front(), testing::MatchesRegex("freeing wrist_2_joint .* to 1[.0-9]* x noise"));
}

TEST(WouldHelp, SaysNothingOfSamplesOfOnePose) {
  const HeldZero held;
  std::vector<Sample> same(40, held.arm.samples().front());
  for (std::size_t i = 0; i < same.size(); ++i) {
    same[i].joint_positions[0] += 1e-6 * static_cast<double>(i);  // as encoders read them
  }
  EXPECT_THAT(helps_of(held.config, held.arm.robot(), same), IsEmpty());
  Calibration calibration = assembled(held.config, held.arm.robot(), same);
  const Judgement judgement = calibrate_and_judge(calibration, same).judgement;
  EXPECT_NE(judgement.verdict, Grade::good);
  EXPECT_THAT(judgement.reasons,
              testing::Contains(testing::StartsWith("all samples are of one pose")));
  EXPECT_THROW((void)find_errors(held.config, held.arm.robot(), same), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
