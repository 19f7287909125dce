// What identify finds: on real robots, in robots with known errors, and in robots without any.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/tools/identify/another_robot.hpp"
#include "kinecal/tools/identify/identified_config.hpp"
#include "kinecal/tools/identify/robot_search.hpp"
#include "kinecal/tools/identify/would_help.hpp"
#include "kinecal/tools/init/answers_from_samples.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "kinecal/trust/observability.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A configuration for a tracker, without a sigma.
Config tracker_config(const Robot& robot, std::span<const Sample> samples) {
  Diagnostics diagnostics;
  Config config = parse_config(initial_config(robot, answers_from_samples(robot, samples, {})),
                               "calibrate.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  for (BlockConfig& block : config.steps.front().error_blocks) block.sigma.reset();
  return config;
}

/// What is found in samples.
struct Found {
  IdentifyTask task;
  Identified identified;
  Config config;  ///< that frees it

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const int k : identified.chosen) {
      all.push_back(task.candidates[static_cast<std::size_t>(k)].name);
    }
    return all;
  }
};

Calibration assembled(const Config& config, const Robot& robot, std::span<const Sample> samples) {
  Diagnostics diagnostics;
  Calibration calibration = assemble(config, robot, samples, diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return calibration;
}

Found find(const Config& config, const Robot& robot, std::span<const Sample> samples,
           bool geometry_only = false) {
  Found found;
  Calibration calibration = assembled(with_all_candidates(config, robot, samples), robot, samples);
  const AnyProblem& problem = *calibration.steps.front().problem;
  found.task = identify_task(config, problem, samples, geometry_only);
  found.identified = identify(calibration, samples, found.task.base, found.task.candidates);
  found.config = identified_config(config, found.task, found.identified, problem);
  return found;
}

/// Root of the mean squared distance in samples, by a configuration that is calibrated with others.
double error_elsewhere(const Config& config, const Robot& robot, std::span<const Sample> fitted,
                       std::span<const Sample> others) {
  const CalibrationResult result = calibrate(assembled(config, robot, fitted));
  EXPECT_TRUE(result.converged);
  const Calibration other = assembled(config, robot, others);
  const Eigen::VectorXd values = result.table.values();
  const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
  return block_statistics(*other.steps.front().problem, all, all)[0].after.rms;
}

TEST(Identify, FindsMoreInTheUr5ThanItsWholeGeometry) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto data = test::data_folder() / "ur5_tracker";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "ur5.urdf").string());
  const auto grid = read_samples((data / "grid.yaml").string(), diagnostics),
             random = read_samples((data / "random.yaml").string(), diagnostics);
  const Config config = tracker_config(robot, grid);
  // 25 well-chosen parameters of its geometry reach 0.1042 mm on these 20 poses, offsets 0.38.
  const Found geometry = find(config, robot, grid, true);
  EXPECT_LT(1e3 * error_elsewhere(geometry.config, robot, grid, random), 0.107);
  EXPECT_LE(geometry.identified.chosen.size(), 25 - 9);
  const Found models = find(config, robot, grid);
  EXPECT_LT(1e3 * error_elsewhere(models.config, robot, grid, random), 0.096);
}

TEST(Identify, FindsGeometryOfThePandaThatHoldsElsewhere) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const auto data = test::data_folder() / "mukca_panda";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "panda.urdf").string());
  const auto samples = read_samples((data / "panda_6/front.yaml").string(), diagnostics);
  const Config config = read_config((data / "panda_6/minimal.yaml").string(), diagnostics);
  const Found found = find(config, robot, samples, true);
  EXPECT_LT(found.identified.steps.back().fitted, 0.22e-3)
      << "0.194 mm with 30 parameters chosen by hand";
}

TEST(Identify, FindsTheErrorsOfTheSimulatedFetch) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const auto data = test::data_folder() / "fetch/synth";
  Diagnostics diagnostics;
  const Robot robot = read_urdf((data / "fetch_arm_head.urdf").string());
  const auto samples = read_samples((data / "samples.yaml").string(), diagnostics);
  const Found found = find(tracker_config(robot, samples), robot, samples);
  EXPECT_THAT(found.names(), testing::IsSupersetOf(
                                 {"frame of head_pan_joint", "shoulder_lift_joint",
                                  "upperarm_roll_joint", "elbow_flex_joint", "forearm_roll_joint",
                                  "wrist_flex_joint", "wrist_roll_joint", "camera_z_scaling"}));
  // 1.7427 mm are left at the truth, by noise.
  EXPECT_LT(found.identified.steps.back().fitted, 1.76e-3);
}

/// A UR5e and a tracker: samples of a robot that is not as its URDF says.
class SimulatedArm {
 public:
  explicit SimulatedArm(unsigned seed) : random_(seed) {
    robot_ = read_urdf(test::source_folder() + "/examples/robots/ur5e/ur5e.urdf");
    samples_ = poses(100);
    others_ = poses(200);
    config_ = tracker_config(robot_, samples_);
    wide_ = with_all_candidates(config_, robot_, samples_);
  }

  /// Makes some candidates wrong, of the size of real errors; returns their numbers.
  /// @param turned  a joint whose zero is off, and by how much, radians
  std::vector<int> spoil(int errors, const std::string& turned = "", double by = 1.5708 + 0.02) {
    const Calibration calibration = assembled(wide_, robot_, samples_);
    task_ = identify_task(config_, *calibration.steps.front().problem, samples_);
    truth_ = calibration.table;
    for (const auto& [name, value] :
         {std::pair("tracker_frame_x", 1.5), std::pair("tracker_frame_y", -0.7),
          std::pair("tracker_frame_c", 0.8), std::pair("smr_x", 0.01), std::pair("smr_y", 0.06),
          std::pair("smr_z", 0.05)}) {
      truth_[name].value = value;
    }
    if (!turned.empty()) truth_[turned].value = by;
    std::set<int> wrong;
    while (static_cast<int>(wrong.size()) < errors) {
      wrong.insert(random_.integer(0, static_cast<int>(task_.candidates.size()) - 1));
    }
    for (const int k : wrong) {
      for (const int p : task_.candidates[static_cast<std::size_t>(k)].parameters) {
        const std::string& unit = truth_[p].unit;
        const double least = unit == "1"             ? 0.005
                             : unit == "m"           ? 0.001
                             : unit.ends_with("/Nm") ? 2e-5
                                                     : 0.004;
        truth_[p].value = random_.either_sign(least, unit == "1" ? 0.01 : 4.0 * least);
        const auto of = joint_model_parameter(robot_, truth_[p].name);
        if (of && of->model->is_never_negative()) truth_[p].value = std::abs(truth_[p].value);
      }
    }
    measure(samples_);
    measure(others_);
    return {wrong.begin(), wrong.end()};
  }

  [[nodiscard]] const Robot& robot() const { return robot_; }
  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] Found found() const { return find(config_, robot_, samples_); }
  /// Error on other poses, of what was found and of these candidates, metres.
  [[nodiscard]] double error(const Config& config) const {
    return error_elsewhere(config, robot_, samples_, others_);
  }
  /// True if no sample can tell a candidate from the unknown poses.
  [[nodiscard]] bool is_in_unknown_poses(int candidate) const {
    const Calibration calibration = assembled(wide_, robot_, samples_);
    std::vector<int> free = task_.base;
    const auto& own = task_.candidates[static_cast<std::size_t>(candidate)].parameters;
    free.insert(free.end(), own.begin(), own.end());
    const Eigen::VectorXd values = truth_.values();
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    const int size = truth_.size();
    return !observability(*calibration.steps.front().problem, FreeSet(free, size), all)
                .unobservable.empty();
  }
  [[nodiscard]] Config config_of(const std::vector<int>& candidates) const {
    const Calibration calibration = assembled(wide_, robot_, samples_);
    Identified as_found;
    as_found.chosen = candidates;
    return identified_config(config_, task_, as_found, *calibration.steps.front().problem);
  }

 private:
  std::vector<Sample> poses(int count) {
    std::vector<Sample> all(static_cast<std::size_t>(count));
    for (Sample& sample : all) {
      for (const Joint& joint : robot_.joints()) {
        if (!moves(joint.type)) continue;
        sample.joint_names.push_back(joint.name);
        sample.joint_positions.push_back(random_.uniform(-2.0, 2.0));
      }
      sample.observations = {{"arm", {{"smr", Vector3<double>::Zero()}}},
                             {"tracker", {{"tracker_frame", random_.normal_vector()}}}};
    }
    set_joint_moves(all);
    return all;
  }
  void measure(std::vector<Sample>& samples) {
    Eigen::VectorXd values = truth_.values();
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    samples = exact_samples(
        [&] { return assembled(wide_, robot_, samples).steps.front().problem->without_samples(); },
        all, samples);
    constexpr double kNoise = 1e-4;
    for (Sample& sample : samples) {
      sample.observations[0].features[0].point.setZero();
      sample.observations[1].features[0].point += kNoise * random_.normal_vector();
    }
  }

  SeededRandom random_;
  Robot robot_;
  std::vector<Sample> samples_, others_;
  Config config_, wide_;
  IdentifyTask task_;
  ParameterTable truth_;
};

TEST(Identify, FreesNothingInAPerfectRobot) {
  const int robots = test::repetitions(200, 5);
  int freed = 0, candidates = 0;
  for (int r = 0; r < robots; ++r) {
    SimulatedArm arm(static_cast<unsigned>(r));
    arm.spoil(0);
    const Found found = arm.found();
    freed += static_cast<int>(found.identified.chosen.size());
    candidates += static_cast<int>(found.task.candidates.size());
  }
  std::printf("%d perfect robots: %d of %d candidates freed\n", robots, freed, candidates);
  EXPECT_LE(freed, 0.02 * candidates);
}

TEST(Identify, NamesWhatIsWrong) {
  const int robots = test::repetitions(200, 5);
  int exact = 0, alike = 0, hidden = 0, missed = 0, invented = 0, worse = 0;
  for (int r = 0; r < robots; ++r) {
    SimulatedArm arm(static_cast<unsigned>(1000 + r));
    const std::vector<int> wrong = arm.spoil(1 + r % 5);
    const Found found = arm.found();
    std::set<int> left(found.identified.chosen.begin(), found.identified.chosen.end());
    for (const int k : wrong) {
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
      ++(other != steps.end() ? alike : arm.is_in_unknown_poses(k) ? hidden : missed);
      if (other != steps.end()) left.erase(other->candidate);
    }
    invented += static_cast<int>(left.size());
    if (arm.error(found.config) > 1.05 * arm.error(arm.config_of(wrong))) ++worse;
  }
  std::printf(
      "%d robots: %d named, %d by what looks alike, %d in the unknown poses, %d missed, %d "
      "invented; %d are worse elsewhere\n",
      robots, exact, alike, hidden, missed, invented, worse);
  EXPECT_LE(worse, 0.05 * robots);
}

TEST(Identify, FindsAZeroThatIsAQuarterTurnOff) {
  SimulatedArm arm(3);
  arm.spoil(0, "wrist_2_joint");
  const Found found = arm.found();
  ASSERT_EQ(found.identified.turned.size(), 1U);
  const auto& [candidate, turn] = found.identified.turned.front();
  EXPECT_EQ(found.task.candidates[static_cast<std::size_t>(candidate)].name, "wrist_2_joint");
  EXPECT_NEAR(turn, 1.5708, 1e-4);
  EXPECT_THAT(found.names(), ElementsAre("wrist_2_joint")) << "by 0.02 rad more";
  EXPECT_LT(arm.error(found.config), 2e-4);
}

TEST(Identify, NamesWhatNoSampleTellsApart) {
  SimulatedArm arm(17);
  arm.spoil(0, "elbow_joint_z", 0.003);  // along the axes of three joints that are parallel
  const RobotSearch search = search_robot(arm.config(), arm.robot(), arm.samples());
  ASSERT_EQ(search.found.chosen.size(), 1U);
  const ReportedSearchStep step = reported(search).steps.at(1);
  std::vector<std::string> names = step.inseparable;
  names.push_back(step.freed);
  EXPECT_THAT(names, testing::IsSupersetOf({"elbow_joint_z", "wrist_1_joint_z"}));
  EXPECT_THAT(search_text(search),
              testing::HasSubstr("no sample like these tells " + step.freed + " from "));
}

TEST(Identify, HasStandardErrorsAndWhatWasTriedAndNotFreed) {
  SimulatedArm arm(12);
  arm.spoil(0, "wrist_2_joint", 0.02);
  const Found found = arm.found();
  const std::vector<IdentifyStep>& steps = found.identified.steps;
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].parameters + 1, steps[1].parameters);
  // 100 poses of 3 components: the root of a mean of so many squares is known to 1 / sqrt(600).
  EXPECT_NEAR(steps[1].deviation / steps[1].held_out, 1.0 / std::sqrt(600.0), 0.02);
  ASSERT_FALSE(found.identified.beyond.empty());
  EXPECT_GT(found.identified.beyond.front().held_out, 0.97 * steps[1].held_out);
  EXPECT_EQ(found.identified.beyond.front().parameters > steps[1].parameters, true);
}

TEST(Identify, SamplesOfAnotherRobotAreNotExplained) {
  SimulatedArm arm(21);
  arm.spoil(0, "elbow_joint_x", 0.004);
  EXPECT_EQ(another_robot(search_robot(arm.config(), arm.robot(), arm.samples())), "");
  arm.spoil(0, "elbow_joint_x", 0.04);
  EXPECT_THAT(another_robot(search_robot(arm.config(), arm.robot(), arm.samples())),
              testing::HasSubstr("another robot, or of another version of it: these samples change "
                                 "elbow_joint_x by 40"));
  arm.spoil(0, "elbow_joint_x", 0.4);
  EXPECT_THAT(another_robot(search_robot(arm.config(), arm.robot(), arm.samples())),
              testing::HasSubstr("are left whatever is freed"));
}

/// What would help a calibration.
std::vector<std::string> helps_of(const Config& config, const Robot& robot,
                                  std::span<const Sample> samples) {
  const Calibration calibration = assembled(config, robot, samples);
  return would_help(config, robot, samples, calibration, calibrate(calibration));
}

/// A robot with a wrong zero, and a configuration that holds it.
struct HeldZero {
  HeldZero() {
    arm.spoil(0, "wrist_2_joint", 0.02);
    config = arm.config();
    std::erase_if(config.steps.front().free_params,
                  [](const FreeParamConfig& free) { return free.name == "wrist_2_joint"; });
  }
  SimulatedArm arm{11};
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
  EXPECT_THROW((void)find(held.config, held.arm.robot(), same), std::invalid_argument);
}

TEST(Identify, WritesAConfigurationThatReadsAsTheSame) {
  SimulatedArm arm(7);
  arm.spoil(3);
  const Found found = arm.found();
  const std::string text = config_to_yaml(found.config, "title", {{"smr_x", "why"}});
  EXPECT_THAT(text, testing::HasSubstr("yaw: false}  # x: why\n"));
  Diagnostics diagnostics;
  const Config read = parse_config(text, "identified.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_EQ(config_to_yaml(read, "title", {{"smr_x", "why"}}), text);
  EXPECT_EQ(arm.error(read), arm.error(found.config));
}

}  // namespace
}  // namespace kinecal
