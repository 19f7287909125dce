// Poses that the configuration does not give: which they are, and that they are found.
#include "kinecal/config/unknown_frames.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/config/few_samples.ipp"
#include "kinecal/sensors/built_in_sensor.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::Chance;
using test::Scenario;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kSameCost = 1e-6;  // relative
/// unknown_poses_study repeats this a thousand times.
#ifdef NDEBUG
constexpr int kRepetitions = 40;
#else
constexpr int kRepetitions = 3;
#endif

std::vector<std::string> unknown_of(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const UnknownFrame& frame : calibration.steps.front().unknown_frames) {
    names.push_back(frame.name);
  }
  return names;
}

void expect_found(const Calibration& calibration, double reference) {
  const CalibrationResult result = calibrate(calibration);
  const StepResult& step = result.steps.back();
  EXPECT_TRUE(result.converged) << result.termination;
  EXPECT_NEAR(step.final_cost / reference, 1.0, kSameCost) << to_string(step.starts);
  EXPECT_GE(step.starts.starts, 60);
  ASSERT_GE(step.starts.taken, 0);
}

// ---- which poses are unknown

TEST(UnknownFrames, AreABoardAndABracketThatTheUrdfPutsAtZero) {
  const Scenario scenario = test::board_scenario(true, 1, 3);
  const Calibration calibration = scenario.calibration();
  EXPECT_THAT(unknown_of(calibration), ElementsAre("bracket", "board"));
  for (const UnknownFrame& frame : calibration.steps[0].unknown_frames) {
    EXPECT_FALSE(frame.has_guess);
    EXPECT_TRUE(frame.turns());
  }
}

TEST(UnknownFrames, HaveAGuessIfTheConfigurationGivesMoreThanZeros) {
  Scenario scenario = test::board_scenario(true, 1, 3);
  StepConfig& step = scenario.config.steps[0];
  step.frame_initial_values = {{.name = "board", .place = {}}};
  step.initial_values = {{.name = "bracket_z", .value = 0.1, .place = {}}};
  const Calibration calibration = scenario.calibration();
  ASSERT_THAT(unknown_of(calibration), ElementsAre("bracket", "board"));
  EXPECT_TRUE(calibration.steps[0].unknown_frames[0].has_guess);
  EXPECT_FALSE(calibration.steps[0].unknown_frames[1].has_guess);
}

TEST(UnknownFrames, AreFoundInSpiteOfABadGuess) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Scenario scenario = test::board_scenario(true, seed, 20);
    const double reference = calibrate(scenario.calibration()).steps.back().final_cost;
    for (const char* frame : {"board", "bracket"}) {
      scenario.config.steps[0].frame_initial_values.push_back(
          {.name = frame, .xyz = {-1.0, 2.0, -3.0}, .rpy = {3.0, 0.2, 2.0}, .place = {}});
    }
    expect_found(scenario.calibration(), reference);
  }
}

TEST(UnknownFrames, AreKnownAfterTheStepThatFoundThem) {
  Scenario scenario = test::board_scenario(true, 1, 3);
  scenario.config.steps.push_back(scenario.config.steps[0]);
  const Calibration calibration = scenario.calibration();
  EXPECT_EQ(calibration.steps[0].unknown_frames.size(), 2u);
  EXPECT_EQ(calibration.steps[1].unknown_frames.size(), 0u);
}

TEST(UnknownFrames, OfTheUrdfHaveAGuess) {
  Scenario scenario = test::board_scenario(true, 1, 3);
  std::vector<Joint> joints = scenario.robot.joints();
  joints.back().origin.translation = {0.0, 0.0, 0.1};
  scenario.robot = Robot("gantry", joints);
  const Calibration calibration = scenario.calibration();
  ASSERT_THAT(unknown_of(calibration), ElementsAre("bracket", "board"));
  EXPECT_TRUE(calibration.steps[0].unknown_frames[0].has_guess);
  EXPECT_FALSE(calibration.steps[0].unknown_frames[1].has_guess);
}

TEST(UnknownFrames, AreNotJointsThatMoveNorThoseThatAPriorHolds) {
  Scenario scenario = test::board_scenario(true, 1, 3);
  BlockConfig prior;
  prior.name = "hold";
  prior.type = "outrageous";
  prior.param = "bracket";
  prior.numbers = {{"joint_scale", 1}, {"position_scale", 1}, {"rotation_scale", 1}, {"mean", 0},
                   {"mean_x", 0},      {"mean_y", 0},         {"mean_z", 0},         {"mean_a", 0},
                   {"mean_b", 0},      {"mean_c", 0}};
  scenario.config.steps[0].error_blocks.push_back(prior);
  FreeFrameConfig moves{.name = "turn_z", .place = {}};
  moves.axes.fill(true);
  scenario.config.steps[0].free_frames.push_back(moves);
  EXPECT_THAT(unknown_of(scenario.calibration()), ElementsAre("board"));
}

// ---- few samples

TEST(UnknownFrames, AreSearchedForWithAFewCornersOfAFewSamples) {
  const Calibration calibration = test::board_scenario(true, 1, 40).calibration();
  const AnyProblem& excerpt = *calibration.steps[0].excerpt;
  EXPECT_EQ(excerpt.num_samples(), 12);
  EXPECT_EQ(excerpt.num_residuals(), 12 * 4 * 3) << "four corners each, and lines of sight";
}

/// The camera sees some corners of the board and lists them in another order.
TEST(UnknownFrames, AreFoundFromPartsOfABoard) {
  Scenario scenario = test::board_scenario(true, 1);
  for (std::size_t n = 0; n < scenario.samples.size(); ++n) {
    std::vector<Observation>& seen = scenario.samples[n].observations;
    for (Observation& observation : seen) {
      for (std::size_t i = 0; i < 35; ++i) observation.features[i].id = static_cast<int>(i);
    }
    std::vector<Feature>& corners = seen[1].features;
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(n), corners.begin() + 12);
    std::reverse(corners.begin(), corners.end());
    if (n == 11) break;
  }
  const Calibration calibration = scenario.calibration();
  EXPECT_EQ(calibration.steps[0].excerpt->num_residuals(), 12 * 4 * 3) << "four corners each";
  expect_found(calibration, test::cost_from_truth(scenario, calibration));
}

TEST(UnknownFrames, TheFewCornersAreThoseOfEachCamera) {
  Sample sample;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Observation board{"board", {}}, left{"left", {}}, right{"right", {}};
  for (int i = 0; i < 9; ++i) {
    const Vector3<double> at(i, 0.0, 0.0), none(nan, nan, nan);
    board.features.push_back({"board", at});
    left.features.push_back({"left", i < 4 ? at : none});
    right.features.push_back({"right", i > 4 ? at : none});
  }
  sample.observations = {board, left, right};
  EXPECT_THAT(detail::far_apart(sample, 9), testing::UnorderedElementsAre(0u, 3u, 6u, 8u));
}

TEST(UnknownFrames, TheFewCornersAreFarApartAndHaveNumbers) {
  Sample sample;
  Observation holder{"board_holder", {}}, eye{"eye", {}};
  for (const Vector3<double>& corner : test::corners()) {
    holder.features.push_back({"board", corner});
    eye.features.push_back({"camera", 1000.0 * corner});
  }
  eye.features[0].point.x() = std::numeric_limits<double>::quiet_NaN();
  sample.observations = {holder, eye};
  const std::vector<std::size_t> chosen = detail::far_apart(sample, 35);
  ASSERT_EQ(chosen.size(), 4u);
  EXPECT_THAT(chosen, testing::Contains(28u));
  EXPECT_THAT(chosen, testing::Contains(34u));
  EXPECT_THAT(chosen, testing::Not(testing::Contains(0u))) << "it is not a number";
}

TEST(UnknownFrames, FeaturesAtOnePlaceAreOne) {
  Sample sample;
  sample.observations = {{"arm", std::vector<Feature>(9, {"smr", {0.0, 0.0, 0.0}})}};
  EXPECT_EQ(detail::far_apart(sample, 9).size(), 1u);
}

TEST(UnknownFrames, RectifiedPixelsLieOnTheSameLineOfSight) {
  Observation seen{"eye", {{"camera", {500.0, 100.0, 0.0}}}, test::camera_info()};
  seen.camera->d = {-0.2, 0.05, 1e-3, -1e-3, 0.01};
  const auto ray = [](const Observation& eye) {
    Measurement<PinholeCamera, double> pixel;
    pixel.point = eye.features[0].point;
    pixel.settings = PinholeCamera{}.settings(eye);
    return PinholeCamera{}.place(pixel, std::array<double, 4>{}).direction;
  };
  Observation rectified = seen;
  detail::rectify(rectified, *any_sensor(PinholeCamera{}));
  EXPECT_GT((rectified.features[0].point - seen.features[0].point).norm(), 1.0);
  EXPECT_TRUE(ray(rectified).isApprox(ray(seen), 1e-12));
}

// ---- found wherever they are

TEST(UnknownPoses, ATrackerIsFoundAnywhere) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  Scenario scenario =
      test::recorded("ur5_tracker/ur5.urdf", "ur5_tracker/full.yaml", "ur5_tracker/grid.yaml");
  for (int n = 0; n < kRepetitions; ++n) {
    Chance chance(static_cast<std::uint64_t>(n));
    Scenario moved = scenario;
    test::move_sensor(moved.samples, "tracker", chance.pose(10.0));
    expect_found(moved.calibration(), 6.233928757e-6);
  }
}

TEST(UnknownPoses, AFixtureIsFoundAnywhere) {
  KINECAL_NEEDS_DATA("mukca_panda");
  Scenario scenario = test::recorded("mukca_panda/panda.urdf", "mukca_panda/panda_6/redundant.yaml",
                                     "mukca_panda/panda_6/front.yaml");
  for (int n = 0; n < kRepetitions; ++n) {
    Chance chance(static_cast<std::uint64_t>(n));
    Scenario moved = scenario;
    test::move_sensor(moved.samples, "fixture", chance.pose(10.0));
    expect_found(moved.calibration(), 1.169456536e-6);
  }
}

TEST(UnknownPoses, ACameraAndABoardAreFoundAnywhere) {
  for (const bool in_hand : {true, false}) {
    for (int n = 0; n < kRepetitions; ++n) {
      const Scenario scenario = test::board_scenario(in_hand, static_cast<std::uint64_t>(n));
      const Calibration calibration = scenario.calibration();
      expect_found(calibration, test::cost_from_truth(scenario, calibration));
    }
  }
}

/// The URDF puts the bracket there, less so much.
Scenario with_guess(Scenario scenario, const Vector3<double>& turn) {
  std::vector<Joint> joints = scenario.robot.joints();
  Pose<double>& origin = joints.back().origin;
  origin = scenario.truth.front().second;
  origin.rotation = Matrix3<double>(origin.rotation * exp(turn));
  origin.translation += Vector3<double>(0.01, -0.01, 0.02);
  scenario.robot = Robot("gantry", joints);
  return scenario;
}

TEST(UnknownPoses, ABoardIsFoundWithTheCameraAboutWhereTheUrdfHasIt) {
  for (int n = 0; n < kRepetitions; ++n) {
    const Scenario scenario = test::board_scenario(n % 2 == 0, static_cast<std::uint64_t>(n));
    const Calibration guessed = with_guess(scenario, {0.05, -0.1, 0.05}).calibration();
    expect_found(guessed, test::cost_from_truth(scenario, scenario.calibration()));
    EXPECT_THAT(calibrate(guessed).steps[0].starts.frames, ElementsAre("board"));
  }
}

TEST(UnknownPoses, ACameraIsFoundThatTheUrdfTurnsTheWrongWay) {
  for (int n = 0; n < kRepetitions; ++n) {
    const Scenario scenario = test::board_scenario(n % 2 == 0, static_cast<std::uint64_t>(n));
    const Calibration wrong = with_guess(scenario, {1.2, -1.2, 0.8}).calibration();
    expect_found(wrong, test::cost_from_truth(scenario, scenario.calibration()));
  }
}

}  // namespace
}  // namespace kinecal
