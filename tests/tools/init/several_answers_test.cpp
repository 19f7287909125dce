#include "kinecal/tools/init/several_answers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/urdf/joined_urdf.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "support/interval_coverage.hpp"
#include "support/thrown.hpp"
#include "support/two_arms.hpp"

namespace kinecal {
namespace {

using test::TwoArms;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

InitAnswers board_in_a_hand() {
  InitAnswers answers;
  answers.target = InitTarget::checkerboard;
  answers.camera_type = "camera2d";
  return answers;
}

std::vector<InitAnswers> both_arms(const Robot& robot) {
  return answers_of_all(robot, board_in_a_hand(), {"left_hand", "right_hand"},
                        {"left_eye", "right_eye"});
}

Config config_of_answers(const Robot& robot, const std::vector<InitAnswers>& answers) {
  Diagnostics diagnostics;
  Config config = parse_config(initial_config(robot, answers), "calibrate.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return config;
}

TEST(SeveralAnswers, ACameraGoesWithEachArmThatDoesNotCarryIt) {
  const Robot robot = parse_urdf(TwoArms::urdf(), "two_arms.urdf");
  const auto all = both_arms(robot);
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(pairs_text(all), "right_eye sees left_hand; left_eye sees right_hand");
  EXPECT_EQ(all[0].target_frame, "left_hand_checkerboard");
  EXPECT_EQ(holder_of(all[0]), "left_hand");
  EXPECT_EQ(all[0].camera_name, "right_eye");
  const Config config = config_of_answers(robot, all);
  const StepConfig& step = config.steps.front();
  std::vector<std::string> names;
  for (const auto& block : step.error_blocks) names.push_back(block.name);
  EXPECT_THAT(names, ElementsAre("hand_eye_right_eye", "hand_eye_left_eye"));
  EXPECT_THAT(step.models, SizeIs(4));
  EXPECT_EQ(config.base_link, "torso");
  names.clear();
  for (const auto& frame : step.free_frames) names.push_back(frame.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("left_hand_checkerboard", "right_joint_0",
                                                   "right_eye_joint", "right_hand_checkerboard",
                                                   "left_eye_joint"))
      << "one of the two bases";
}

TEST(SeveralAnswers, AreRefusedIfALinkOccursTwiceOrACameraSeesNothing) {
  const Robot robot = parse_urdf(TwoArms::urdf(), "two_arms.urdf");
  const auto refusal = [&](std::vector<std::string> arms, std::vector<std::string> cameras) {
    return test::thrown<InputError>(
        [&] { (void)answers_of_all(robot, board_in_a_hand(), arms, cameras); }, "");
  };
  EXPECT_EQ(refusal({"left_hand", "left_hand"}, {"right_eye"}), "--arm: 'left_hand' occurs twice");
  EXPECT_THAT(refusal({"left_hand"}, {"left_eye", "right_eye"}),
              HasSubstr("--camera: 'left_eye' moves with each arm that is given"));
  EXPECT_THAT(refusal({"left_hand", "right_hand"}, {"left_eye"}),
              HasSubstr("--arm: 'left_hand' moves with each camera that is given"));
}

TEST(SeveralAnswers, ComeFromSamplesOfSeveralCameras) {
  const TwoArms arms(3, 4);
  const auto all = all_answers_from_samples(arms.robot, arms.samples, {});
  EXPECT_EQ(pairs_text(all), "left_eye sees right_hand; right_eye sees left_hand");
  EXPECT_EQ(config_of_answers(arms.robot, all).steps.front().models.size(), 4u);
  std::vector<Sample> same_frame = arms.samples;
  for (Sample& sample : same_frame) {
    for (Feature& feature : sample.observations.front().features) feature.frame = "board";
  }
  EXPECT_THAT(test::thrown<InputError>(
                  [&] { (void)all_answers_from_samples(arms.robot, same_frame, {}); }, ""),
              HasSubstr("are both in frame 'board', but are two targets"));
}

/// Zeros of both arms, both boards and where each camera is on its hand, from boards that nobody measured.
TEST(SeveralAnswersCoverage, OfTwoArmsThatSeeEachOthersBoards) {
  test::IntervalCoverage coverage("two arms that see each other's boards");
  const int runs = test::repetitions_of_study(200, 12);
  const Robot robot = parse_urdf(TwoArms::urdf(), "two_arms.urdf");
  std::vector<InitAnswers> answers = both_arms(robot);
  for (InitAnswers& one : answers) one.known_lens = true;
  const Config config = config_of_answers(robot, answers);
  std::set<std::string> free;
  for (const FreeParamConfig& joint : config.steps.front().free_params) free.insert(joint.name);
  EXPECT_GE(free.size(), 8u) << "four or more of each arm";
  for (int run = 0; run < runs; ++run) {
    const TwoArms arms(7000 + std::uint64_t(run), 30, free);
    Diagnostics diagnostics;
    const Calibration calibration = assemble(config, arms.robot, arms.samples, diagnostics);
    diagnostics.throw_if_errors();
    const CalibrationResult result = calibrate(calibration);
    coverage.add(result, test::assessment_of(calibration, result, arms.samples),
                 [&](const std::string& name) { return arms.truth(name); });
  }
  coverage.check();
}

// ---- two robots, each with its URDF

/// The arms of TwoArms as two robots with one URDF, the first where its torso is.
std::string joined_arms() {
  const std::string both = TwoArms::urdf();
  const std::size_t begin = both.find("<link name=\"left_0\"/>"),
                    end = both.find("<link name=\"right_0\"/>");
  std::string arm =
      "<robot name=\"arm\"><link name=\"torso\"/>" + both.substr(begin, end - begin) + "</robot>";
  for (std::size_t at; (at = arm.find("left_")) != std::string::npos;) arm.erase(at, 5);
  return joined_urdf(
      std::vector<RobotPart>{{"left", arm, "left.urdf"}, {"right", arm, "right.urdf"}});
}

const std::vector<std::string> kStands = {"world_left", "world_right"};

TEST(SeveralAnswers, FindWhereTheSecondRobotStands) {
  const Robot robot = parse_urdf(joined_arms(), "robots.urdf");
  std::vector<InitAnswers> all = both_arms(robot);
  relate_stands(robot, kStands, all);
  const Config config = config_of_answers(robot, all);
  std::vector<std::string> names;
  for (const auto& frame : config.steps.front().free_frames) names.push_back(frame.name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("left_hand_checkerboard", "world_right",
                                                   "right_eye_joint", "right_hand_checkerboard",
                                                   "left_eye_joint"))
      << "the stand in place of the first joint's frame";
}

TEST(SeveralAnswers, AreRefusedIfNothingRelatesTwoRobots) {
  const Robot robot = parse_urdf(joined_arms(), "robots.urdf");
  InitAnswers answers = board_in_a_hand();
  answers.target = InitTarget::world_checkerboard;
  const auto refusal = [&](const std::vector<std::string>& cameras) {
    return test::thrown<InputError>(
        [&] {
          std::vector<InitAnswers> all = answers_of_all(robot, answers, {}, cameras);
          relate_stands(robot, kStands, all);
        },
        "nothing");
  };
  EXPECT_EQ(refusal({"left_eye", "right_eye"}), "nothing") << "both see the board";
  EXPECT_THAT(refusal({"left_eye"}),
              HasSubstr("nothing says where the robot on 'world_right' stands"));
}

/// From no guess of where the second one stands.
TEST(SeveralAnswersCoverage, OfTwoRobotsThatSeeEachOthersBoards) {
  test::IntervalCoverage coverage("two robots that see each other's boards");
  const int runs = test::repetitions_of_study(100, 12);
  const Robot robot = parse_urdf(joined_arms(), "robots.urdf");
  std::vector<InitAnswers> answers = both_arms(robot);
  for (InitAnswers& one : answers) one.known_lens = true;
  relate_stands(robot, kStands, answers);
  const Config config = config_of_answers(robot, answers);
  std::set<std::string> free;
  for (const FreeParamConfig& joint : config.steps.front().free_params) free.insert(joint.name);
  EXPECT_GE(free.size(), 8u) << "four or more of each arm";
  for (int run = 0; run < runs; ++run) {
    const TwoArms arms(9000 + std::uint64_t(run), 30, free);
    Diagnostics diagnostics;
    const Calibration calibration = assemble(config, robot, arms.samples, diagnostics);
    diagnostics.throw_if_errors();
    const CalibrationResult result = calibrate(calibration);
    coverage.add(
        result, test::assessment_of(calibration, result, arms.samples),
        [&](const std::string& name) { return name == "world_right_y" ? -0.5 : arms.truth(name); });
  }
  coverage.check();
}

}  // namespace
}  // namespace kinecal
