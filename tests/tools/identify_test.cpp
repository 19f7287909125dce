// What identify finds: on real robots, in robots with known errors, and in robots without any.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>

#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/identify/another_robot.hpp"
#include "kinecal/tools/identify/identified_config.hpp"
#include "kinecal/tools/identify/robot_search.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/repetitions.hpp"
#include "support/spoiled_robot.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using test::assembled;
using test::error_elsewhere;
using test::find_errors;
using test::FoundErrors;
using test::SpoiledRobot;
using test::tracker_config;

TEST(Identify, FindsMoreInTheUr5ThanItsWholeGeometry) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto data = test::data_folder() / "ur5_tracker";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "ur5.urdf").string());
  const auto grid = read_samples((data / "grid.yaml").string(), diagnostics),
             random = read_samples((data / "random.yaml").string(), diagnostics);
  const Config config = tracker_config(robot, grid);
  // 25 well-chosen parameters of its geometry reach 0.1042 mm on these 20 poses, offsets 0.38.
  const FoundErrors geometry = find_errors(config, robot, grid, true);
  EXPECT_LT(1e3 * error_elsewhere(geometry.config, robot, grid, random), 0.107);
  EXPECT_LE(geometry.identified.chosen.size(), 25 - 9);
  const FoundErrors models = find_errors(config, robot, grid);
  EXPECT_LT(1e3 * error_elsewhere(models.config, robot, grid, random), 0.096);
}

TEST(Identify, FindsGeometryOfThePandaThatHoldsElsewhere) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const auto data = test::data_folder() / "mukca_panda";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "panda.urdf").string());
  const auto samples = read_samples((data / "panda_6/front.yaml").string(), diagnostics);
  const Config config = read_config((data / "panda_6/minimal.yaml").string(), diagnostics);
  const FoundErrors found = find_errors(config, robot, samples, true);
  EXPECT_LT(found.identified.steps.back().fitted, 0.22e-3)
      << "0.194 mm with 30 parameters chosen by hand";
}

TEST(Identify, FindsTheSameInAnyOrderOfTheSamples) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const auto data = test::data_folder() / "mukca_panda";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "panda.urdf").string());
  auto samples = read_samples((data / "panda_6/front.yaml").string(), diagnostics);
  const Config config = read_config((data / "panda_6/minimal.yaml").string(), diagnostics);
  const std::vector<std::string> names = find_errors(config, robot, samples).names();
  std::reverse(samples.begin(), samples.end());
  EXPECT_EQ(find_errors(config, robot, samples).names(), names);
}

TEST(Identify, FindsTheErrorsOfTheSimulatedFetch) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const auto data = test::data_folder() / "fetch/synth";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "fetch_arm_head.urdf").string());
  const auto samples = read_samples((data / "samples.yaml").string(), diagnostics);
  const FoundErrors found = find_errors(tracker_config(robot, samples), robot, samples);
  EXPECT_THAT(found.names(), testing::IsSupersetOf(
                                 {"frame of head_pan_joint", "shoulder_lift_joint",
                                  "upperarm_roll_joint", "elbow_flex_joint", "forearm_roll_joint",
                                  "wrist_flex_joint", "wrist_roll_joint", "camera_z_scaling"}));
  // 1.7427 mm are left at the truth, by noise.
  EXPECT_LT(found.identified.steps.back().fitted, 1.76e-3);
}

/// What became of the errors of robots: named; named by what looks alike; not to be told from unknown
/// poses; too small to matter elsewhere; missed; and of candidates that were none.
struct Counts {
  int robots = 0, candidates = 0, wrong = 0, exact = 0, alike = 0, hidden = 0, small = 0,
      missed = 0, invented = 0, worse = 0;

  /// Adds a robot.
  void add(const SpoiledRobot& arm, const std::vector<int>& spoiled) {
    const FoundErrors found = arm.found();
    EXPECT_TRUE(found.identified.result.converged);
    ++robots;
    candidates += static_cast<int>(found.task.candidates.size());
    wrong += static_cast<int>(spoiled.size());
    std::set<int> left(found.identified.chosen.begin(), found.identified.chosen.end());
    std::set<int> seen(spoiled.begin(), spoiled.end());
    std::erase_if(seen, [&](int k) { return arm.is_in_unknown_poses(k); });
    const auto error_of = [&](const std::set<int>& free) {
      return arm.error(arm.config_of({free.begin(), free.end()}));
    };
    const double best = error_of(seen);  // of the truth's own set
    const auto is_small = [&](int k) {   // it makes no difference elsewhere
      std::set<int> without = seen;
      without.erase(k);
      return error_of(without) < 1.01 * best;
    };
    for (const int k : spoiled) {
      if (left.erase(k) > 0) {
        ++exact;
        continue;
      }
      const auto as_well = [&](const IdentifyStep& step) {
        return left.contains(step.candidate) &&
               std::find(step.alike.begin(), step.alike.end(), k) != step.alike.end();
      };
      const auto& steps = found.identified.steps;
      const auto other = std::find_if(steps.begin(), steps.end(), as_well);
      if (other != steps.end()) left.erase(other->candidate);
      ++(other != steps.end() ? alike : !seen.contains(k) ? hidden : is_small(k) ? small : missed);
    }
    invented += static_cast<int>(left.size());
    if (arm.error(found.config) > 1.05 * best) ++worse;
  }
  void add(const Counts& other) {
    for (const auto count :
         {&Counts::robots, &Counts::candidates, &Counts::wrong, &Counts::exact, &Counts::alike,
          &Counts::hidden, &Counts::small, &Counts::missed, &Counts::invented, &Counts::worse}) {
      this->*count += other.*count;
    }
  }
  void print(const std::string& of) const {
    std::printf(
        "%s: %d robots, %d errors, %d candidates: %d named, %d by what looks alike, %d in the "
        "unknown poses, %d too small to matter, %d missed, %d invented; %d robots are worse "
        "elsewhere\n",
        of.c_str(), robots, wrong, candidates, exact, alike, hidden, small, missed, invented,
        worse);
  }
};

/// What becomes of robots of all kinds.
/// @param robots  of each kind
/// @param seed    of the first
/// @param errors  of a robot, by its number
template <class Errors>
Counts counts_of(int robots, unsigned seed, const Errors& errors) {
  Counts all;
  int number = 0;
  for (const test::RobotKind& kind : test::robot_kinds()) {
    Counts of_kind;
    for (int r = 0; r < robots; ++r) {
      SpoiledRobot arm(seed + static_cast<unsigned>(r), kind);
      of_kind.add(arm, arm.spoil(errors(number++)));
    }
    of_kind.print(kind.name);
    all.add(of_kind);
  }
  all.print("all");
  EXPECT_LE(all.invented, 0.02 * all.candidates);
  EXPECT_LE(all.worse, 0.05 * all.robots);
  return all;
}

TEST(Identify, FreesNothingInAPerfectRobot) {
  (void)counts_of(test::repetitions_of_study(34, 1), 0, [](int) { return 0; });
}

TEST(Identify, NamesWhatIsWrong) {
  const Counts all = counts_of(test::repetitions_of_study(84, 3), 1000,
                               [](int number) { return 1 + 2 * (number % 3); });
  EXPECT_LE(all.missed, 0.1 * all.wrong);
}

TEST(Identify, FindsAZeroThatIsAQuarterTurnOff) {
  SpoiledRobot arm(3);
  arm.spoil(0, "wrist_2_joint");
  const FoundErrors found = arm.found();
  ASSERT_EQ(found.identified.turned.size(), 1U);
  const auto& [candidate, turn] = found.identified.turned.front();
  EXPECT_EQ(found.task.candidates[static_cast<std::size_t>(candidate)].name, "wrist_2_joint");
  EXPECT_NEAR(turn, 1.5708, 1e-4);
  EXPECT_THAT(found.names(), ElementsAre("wrist_2_joint")) << "by 0.02 rad more";
  EXPECT_LT(arm.error(found.config), 2e-4);
}

/// The turns that a search finds, by joint, where positions of a camera in the hand are recorded with other zeros.
std::map<std::string, double> turns_found(const std::map<std::string, double>& zeros) {
  SpoiledRobot arm(4, test::robot_kinds()[4]);
  arm.spoil(0);
  std::vector<Sample> samples = arm.samples();
  for (Sample& sample : samples) {
    for (std::size_t j = 0; j < sample.joint_names.size(); ++j) {
      const auto zero = zeros.find(sample.joint_names[j]);
      if (zero != zeros.end()) sample.joint_positions[j] -= zero->second;
    }
  }
  const RobotSearch search = search_robot(arm.config(), arm.robot(), samples);
  EXPECT_TRUE(search.found.result.converged);
  std::map<std::string, double> turns;
  for (const auto& [k, by] : search.found.turned) {
    turns[search.task.candidates[static_cast<std::size_t>(k)].name] = by;
  }
  return turns;
}

TEST(Identify, FindsQuarterTurnsWithWhichACameraSeesNothing) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const std::map<std::string, double> zeros = {{"panda_joint6", kQuarter}};
  EXPECT_EQ(turns_found(zeros), zeros);
  const std::map<std::string, double> two = {{"panda_joint4", -kQuarter},
                                             {"panda_joint6", kQuarter}};
  EXPECT_EQ(turns_found(two), two) << "both are outside their limits";
}

TEST(Identify, NamesWhatNoSampleTellsApart) {
  SpoiledRobot arm(17);
  arm.spoil(0, "elbow_joint_z", 0.003);  // along the axes of three joints that are parallel
  const RobotSearch search = search_robot(arm.config(), arm.robot(), arm.samples());
  ASSERT_EQ(search.found.chosen.size(), 1U);
  const ReportedSearchStep step = reported(search).steps.at(1);
  std::vector<std::string> names = step.inseparable;
  names.push_back(step.freed);
  EXPECT_THAT(names, testing::IsSupersetOf({"elbow_joint_z", "wrist_1_joint_z"}));
  EXPECT_THAT(search_text(search), HasSubstr("either " + step.freed + " or "));
}

TEST(Identify, HasStandardErrorsAndWhatWasTriedAndNotFreed) {
  SpoiledRobot arm(12);
  arm.spoil(0, "wrist_2_joint", 0.02);
  const FoundErrors found = arm.found();
  const std::vector<IdentifyStep>& steps = found.identified.steps;
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].parameters + 1, steps[1].parameters);
  // 100 poses of 3 components: the root of a mean of so many squares is known to 1 / sqrt(600).
  EXPECT_NEAR(steps[1].deviation / steps[1].held_out, 1.0 / std::sqrt(600.0), 0.02);
  ASSERT_FALSE(found.identified.beyond.empty());
  EXPECT_GT(found.identified.beyond.front().held_out, 0.97 * steps[1].held_out);
  EXPECT_EQ(found.identified.beyond.front().parameters > steps[1].parameters, true);
}

/// The judgement of a calibration that frees one more parameter.
Judgement judged_with(const SpoiledRobot& arm, const std::string& parameter) {
  Config config = arm.config();
  StepConfig& step = config.steps.front();
  step.free_params = {{parameter, step.place}};
  Calibration calibration = assembled(config, arm.robot(), arm.samples());
  return calibrate_and_judge(calibration, arm.samples()).judgement;
}

TEST(Identify, TheVerdictDoubtsPlayBelowZero) {
  SpoiledRobot arm(5);
  arm.spoil(0, "elbow_joint_backlash", -0.002);
  EXPECT_THAT(judged_with(arm, "elbow_joint_backlash").reasons,
              testing::Contains(HasSubstr("'elbow_joint_backlash' is -0.1")));
  arm.spoil(0, "elbow_joint_backlash", 0.002);
  EXPECT_THAT(judged_with(arm, "elbow_joint_backlash").reasons, IsEmpty());
}

TEST(Identify, TheVerdictNamesAQuarterTurn) {
  SpoiledRobot arm(5);
  arm.spoil(0, "wrist_2_joint", 1.57);
  EXPECT_THAT(judged_with(arm, "wrist_2_joint").reasons,
              testing::Contains(HasSubstr("A quarter turn: is the motor screwed on so?")));
}

TEST(Identify, SamplesOfAnotherRobotAreNotExplained) {
  SpoiledRobot arm(21);
  arm.spoil(0, "elbow_joint_x", 0.004);
  EXPECT_EQ(another_robot(search_robot(arm.config(), arm.robot(), arm.samples())), "");
  arm.spoil(0, "elbow_joint_x", 0.04);
  EXPECT_THAT(another_robot(search_robot(arm.config(), arm.robot(), arm.samples())),
              HasSubstr("another robot, or of another version of it: these samples change "
                        "elbow_joint_x by 40"));
  arm.spoil(0, "elbow_joint_x", 0.4);
  EXPECT_THAT(another_robot(search_robot(arm.config(), arm.robot(), arm.samples())),
              HasSubstr("are left whatever is freed"));
}

TEST(Identify, WritesAConfigurationThatReadsAsTheSame) {
  SpoiledRobot arm(7);
  arm.spoil(3);
  const FoundErrors found = arm.found();
  const std::string text = config_to_yaml(found.config, "title", {{"smr_x", "why"}});
  EXPECT_THAT(text, HasSubstr("yaw: false}  # x: why\n"));
  Diagnostics diagnostics;
  const Config read = parse_config(text, "identified.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_EQ(config_to_yaml(read, "title", {{"smr_x", "why"}}), text);
  EXPECT_EQ(arm.error(read), arm.error(found.config));
}

}  // namespace
}  // namespace kinecal
