// Robots of six kinds that are not as their URDFs say, in ways that are known: which of the candidates of a
// search are wrong, and by how much; and samples of them, with noise.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/tools/identify/identified_config.hpp"
#include "kinecal/tools/init/answers_from_samples.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/simulation/pose_samples.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "support/paths.hpp"

namespace kinecal::test {

/// A configuration for a tracker, without a sigma.
inline Config tracker_config(const Robot& robot, std::span<const Sample> samples) {
  Diagnostics diagnostics;
  Config config = parse_config(initial_config(robot, answers_from_samples(robot, samples, {})),
                               "calibrate.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, testing::IsEmpty());
  for (BlockConfig& block : config.steps.front().error_blocks) block.sigma.reset();
  return config;
}

inline Calibration assembled(const Config& config, const Robot& robot,
                             std::span<const Sample> samples) {
  Diagnostics diagnostics;
  Calibration calibration = assemble(config, robot, samples, diagnostics);
  EXPECT_THAT(diagnostics.errors, testing::IsEmpty());
  return calibration;
}

/// What is found in samples.
struct FoundErrors {
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

inline FoundErrors find_errors(const Config& config, const Robot& robot,
                               std::span<const Sample> samples, bool geometry_only = false) {
  FoundErrors found;
  Calibration calibration = assembled(with_all_candidates(config, robot, samples), robot, samples);
  const AnyProblem& problem = *calibration.steps.front().problem;
  found.task = identify_task(config, problem, samples, geometry_only);
  found.identified = identify(calibration, samples, found.task.base, found.task.candidates);
  found.config = identified_config(config, found.task, found.identified, problem);
  return found;
}

/// Root of the mean squared distance in samples, by a configuration that is calibrated with others: of
/// parameters that nothing tells apart, too.
inline double error_elsewhere(const Config& config, const Robot& robot,
                              std::span<const Sample> fitted, std::span<const Sample> others) {
  const CalibrationResult result = calibrate(assembled(config, robot, fitted));
  const Calibration other = assembled(config, robot, others);
  const Eigen::VectorXd values = result.table.values();
  const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
  return block_statistics(*other.steps.front().problem, all, all)[0].after.rms;
}

/// A robot of the examples and what it is measured with.
struct RobotKind {
  std::string name;
  std::string urdf;    ///< below examples/robots
  std::string target;  ///< as `kinecal simulate` has it; empty: a reflector and a tracker
  bool on_rail = false;

  [[nodiscard]] Robot robot() const {
    const std::string file = source_folder() + "/examples/robots/" + urdf;
    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (on_rail) {
      text.insert(text.rfind("</robot>"),
                  "<link name=\"floor\"/><joint name=\"rail_joint\" type=\"prismatic\">"
                  "<parent link=\"floor\"/><child link=\"base\"/><axis xyz=\"1 0 0\"/>"
                  "<limit lower=\"-2\" upper=\"2\" effort=\"100\" velocity=\"0.5\"/></joint>");
    }
    return parse_urdf(text, file);
  }
};

inline const std::vector<RobotKind>& robot_kinds() {
  static const std::vector<RobotKind> kinds = {
      {"arm and tracker", "ur5e/ur5e.urdf", ""},
      {"arm on a rail and tracker", "ur5e/ur5e.urdf", "", true},
      {"LEDs and depth camera in the head", "fetch/fetch.urdf", "leds"},
      {"board and camera in the head, torso lift", "tiago/tiago.urdf", "checkerboard"},
      {"camera in the hand", "panda/panda.urdf", "checkerboard"},
      {"tags and camera in the head", "ubr1/ubr1.urdf", "apriltag"}};
  return kinds;
}

/// Poses in which the camera sees the target, and the poses of what is not in the URDF.
struct SeenPoses {
  Config config;
  std::vector<Sample> samples;
  ParameterTable values;

  /// Those of a kind, generated once.
  static const SeenPoses& of(const RobotKind& kind) {
    static std::map<std::string, SeenPoses> known;
    const auto [at, is_new] = known.try_emplace(kind.name);
    return is_new ? (at->second = generated(kind)) : at->second;
  }

 private:
  static SeenPoses generated(const RobotKind& kind) {
    Diagnostics diagnostics;
    SimulationPlan plan = read_simulation(kind.robot(), "", kind.target, 1, diagnostics);
    plan.poses = 300;
    SeenPoses seen;
    seen.config = parse_config(plan.config, "calibrate.yaml", diagnostics);
    diagnostics.throw_if_errors();
    std::vector<BlockConfig>& blocks = seen.config.steps.front().error_blocks;
    blocks.resize(1);  // without priors
    blocks.front().sigma.reset();
    std::vector<CapturePose> poses;
    for (JointTarget& target : poses_of(plan)) {
      poses.push_back({std::move(target.names), std::move(target.positions), {}});
    }
    PoseSamples made = pose_samples(plan, seen.config, poses);
    seen.samples = std::move(made.samples);
    seen.values = std::move(made.values);
    return seen;
  }
};

/// A robot that is not as its URDF says, and samples of it.
class SpoiledRobot {
 public:
  explicit SpoiledRobot(unsigned seed, const RobotKind& kind = robot_kinds().front())
      : kind_(kind), random_(seed), robot_(kind.robot()) {
    if (has_tracker()) {
      samples_ = tracked_poses(100);
      others_ = tracked_poses(200);
      config_ = tracker_config(robot_, samples_);
    } else {
      seen_poses();
    }
    wide_ = with_all_candidates(config_, robot_, samples_);
  }

  /// Makes some candidates wrong, of the size of real errors; returns their numbers.
  /// @param turned  a joint whose zero is off, and by how much, radians
  std::vector<int> spoil(int errors, const std::string& turned = "", double by = 1.5708 + 0.02) {
    const Calibration calibration = assembled(wide_, robot_, samples_);
    task_ = identify_task(config_, *calibration.steps.front().problem, samples_);
    truth_ = calibration.table;
    set_unknown_poses();
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
    std::set<std::string> names;
    for (const int k : wrong) names.insert(task_.candidates[static_cast<std::size_t>(k)].name);
    measure(samples_);
    measure(others_);
    return numbers_of(names);
  }

  [[nodiscard]] const Robot& robot() const { return robot_; }
  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  /// Samples of other poses.
  [[nodiscard]] const std::vector<Sample>& others() const { return others_; }
  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const IdentifyTask& task() const { return task_; }
  [[nodiscard]] FoundErrors found() const { return find_errors(config_, robot_, samples_); }
  /// Error on other poses, of what was found and of these candidates, in the unit of the error block.
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
    return !observability(*calibration.steps.front().problem, FreeSet(free, truth_.size()), all)
                .unobservable.empty();
  }
  [[nodiscard]] Config config_of(const std::vector<int>& candidates) const {
    const Calibration calibration = assembled(wide_, robot_, samples_);
    Identified as_found;
    as_found.chosen = candidates;
    return identified_config(config_, task_, as_found, *calibration.steps.front().problem);
  }

 private:
  [[nodiscard]] bool has_tracker() const { return kind_.target.empty(); }

  std::vector<Sample> tracked_poses(int count) {
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

  /// Draws 60 poses to fit and 150 others.
  void seen_poses() {
    const SeenPoses& all = SeenPoses::of(kind_);
    config_ = all.config;
    std::vector<Sample> poses = all.samples;
    for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
      const int j = random_.integer(static_cast<int>(i), static_cast<int>(poses.size()) - 1);
      std::swap(poses[i], poses[static_cast<std::size_t>(j)]);
    }
    constexpr std::ptrdiff_t kFitted = 60, kOthers = 150;
    ASSERT_GE(std::ssize(poses), kFitted + kOthers);
    samples_.assign(poses.begin(), poses.begin() + kFitted);
    others_.assign(poses.begin() + kFitted, poses.begin() + kFitted + kOthers);
    set_joint_moves(samples_);
    set_joint_moves(others_);
  }

  void set_unknown_poses() {
    if (has_tracker()) {
      for (const auto& [name, value] :
           {std::pair("tracker_frame_x", 1.5), std::pair("tracker_frame_y", -0.7),
            std::pair("tracker_frame_c", 0.8), std::pair("smr_x", 0.01), std::pair("smr_y", 0.06),
            std::pair("smr_z", 0.05)}) {
        truth_[name].value = value;
      }
      return;
    }
    const ParameterTable& known = SeenPoses::of(kind_).values;
    for (const int p : task_.base) {  // the camera's mount, too
      const double size = truth_[p].unit == "m" ? 0.005 : 0.02;
      truth_[p].value = random_.either_sign(0.2 * size, size);
    }
    for (const Parameter& p : known) truth_[p.name].value = p.value;
  }

  /// The numbers of candidates in the task of what was measured: encoder noise can make others.
  std::vector<int> numbers_of(const std::set<std::string>& names) {
    wide_ = with_all_candidates(config_, robot_, samples_);
    const Calibration calibration = assembled(wide_, robot_, samples_);
    task_ = identify_task(config_, *calibration.steps.front().problem, samples_);
    ParameterTable table = calibration.table;
    for (int i = 0; i < table.size(); ++i) {
      const int known = truth_.find(table[i].name);
      if (known >= 0) table[i].value = truth_[known].value;
    }
    truth_ = table;
    std::vector<int> numbers;
    for (std::size_t k = 0; k < task_.candidates.size(); ++k) {
      if (names.contains(task_.candidates[k].name)) numbers.push_back(static_cast<int>(k));
    }
    return numbers;
  }

  void measure(std::vector<Sample>& samples) {
    Eigen::VectorXd values = truth_.values();
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    const auto make = [&] {
      return assembled(wide_, robot_, samples).steps.front().problem->without_samples();
    };
    samples = exact_samples(make, all, samples);
    if (has_tracker()) {
      constexpr double kNoise = 1e-4;
      for (Sample& sample : samples) {
        sample.observations[0].features[0].point.setZero();
        sample.observations[1].features[0].point += kNoise * random_.normal_vector();
      }
      return;
    }
    const auto problem = make();
    const std::set<std::string> measuring = measuring_sensors(*problem, samples);
    const MeasurementNoise noise{.joint = 1e-5};
    for (Sample& sample : samples) {
      sample = with_noise(sample, *problem, measuring, noise, random_);
    }
  }

  RobotKind kind_;
  SeededRandom random_;
  Robot robot_;
  std::vector<Sample> samples_, others_;
  Config config_, wide_;
  IdentifyTask task_;
  ParameterTable truth_;
};

}  // namespace kinecal::test
