// Arms whose reflectors a tracker measures.  The robot is not as its model: links are longer and gears uneven, by
// more than anything that is calibrated can take up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust.hpp"
#include "support/robots.hpp"
#include "support/slip_size.hpp"

namespace kinecal::test {

/// How an arm is recorded, and how far it is from its model.
struct ArmKind {
  const char* name;
  int axes;        ///< 6: 1.5 m and stiff; 7: 0.8 m and light
  int points;      ///< reflectors in the tool
  double noise;    ///< of a coordinate of a reflector, metres
  double repeats;  ///< of a joint, radians
  double links;    ///< of each link, metres and radians
  double gears;    ///< of each joint once a turn, radians
  int poses = 50;  ///< calibrated
  int again = 5;   ///< new poses
};

inline constexpr ArmKind kArmKinds[] = {
    {"stiff arm, exact, joints to 0.05 mrad", 6, 3, 5e-5, 5e-5, 0.0, 0.0},
    {"stiff arm, links off by 0.3 mm", 6, 3, 5e-5, 5e-5, 3e-4, 0.0},
    {"stiff arm, gears by 1 mrad", 6, 3, 5e-5, 5e-5, 0.0, 1e-3},
    {"light arm, links 1 mm, gears 2 mrad", 7, 3, 1e-4, 3e-4, 1e-3, 2e-3},
    {"light arm, links 3 mm", 7, 3, 3e-5, 3e-4, 3e-3, 0.0},
    {"light arm, one point, links 1 mm", 7, 1, 1e-4, 3e-4, 1e-3, 1e-3},
};

/// The model of such an arm, with the tracker beside it.
inline Robot arm_robot(int axes) {
  using Links = std::vector<std::pair<Vector3<double>, Vector3<double>>>;  // origin and axis
  const Links stiff = {{{0, 0, 0.2}, {0, 0, 1}},  {{0.15, 0, 0.28}, {0, 1, 0}},
                       {{0, 0, 0.7}, {0, 1, 0}},  {{0.31, 0, 0.11}, {1, 0, 0}},
                       {{0.29, 0, 0}, {0, 1, 0}}, {{0.07, 0, 0}, {1, 0, 0}}};
  const Links light = {{{0.15, 0, 0.1}, {0, 0, 1}},  {{0.12, 0.02, 0}, {0, 1, 0}},
                       {{0.09, 0, 0}, {1, 0, 0}},    {{0.22, 0, -0.02}, {0, 1, 0}},
                       {{0.16, 0, 0.02}, {1, 0, 0}}, {{0.15, 0, 0}, {0, 1, 0}},
                       {{0.02, 0, 0}, {1, 0, 0}}};
  std::vector<Joint> joints;
  std::string link = "base_link";
  for (const auto& [xyz, axis] : axes == 6 ? stiff : light) {
    const std::string number = std::to_string(joints.size() + 1);
    joints.push_back(
        {"joint_" + number, JointType::revolute, link, "link_" + number, origin(xyz), axis});
    link = "link_" + number;
  }
  joints.push_back({"tool", JointType::fixed, link, "tool_link", origin({0.08, 0, 0.05})});
  joints.push_back({"tracker", JointType::fixed, "base_link", "tracker_link",
                    origin({1.8, -0.9, 0.4}, {0.1, -0.2, 2.0})});
  return Robot("arm", std::move(joints));
}

/// A calibration of an arm and new samples of it; the arm may have changed meanwhile.
class TrackedArm {
 public:
  TrackedArm(const ArmKind& kind, unsigned seed)
      : kind_(kind), model_(arm_robot(kind.axes)), random_(seed + 4000) {
    std::vector<Joint> joints = model_.joints();
    for (Joint& joint : joints) {
      const Vector3<double> turn = kind_.links * vector(), shift = kind_.links * vector();
      joint.origin = joint.origin * Pose<double>{rotation_from_rpy(turn), shift};
    }
    robot_ = Robot("true", std::move(joints));
    const std::vector<std::string> names = joint_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool calibrated = i > 0 && i + 1 < names.size();
      offsets_[names[i]] = calibrated ? 0.02 * normal_(random_) : 0.0;
      phases_[names[i]] = 6.0 * normal_(random_);
    }
    old_ = measured(poses(kind_.poses));
    calibration_ = {table(), {}};
    calibration_.steps.push_back({"calibrate", 1000, problem(old_), free_of_table(), {}});
    result_ = calibrate(calibration_);
    EXPECT_TRUE(result_.converged) << result_.termination;
    assessment_ = assess(calibration_, result_, old_, {.folds = 0}).back();
    record();
  }
  /// Names of its joints.
  [[nodiscard]] std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (int i = 1; i <= kind_.axes; ++i) names.push_back("joint_" + std::to_string(i));
    return names;
  }
  /// Records new poses.
  void record() { fresh = measured(poses(kind_.again)); }
  /// Measures the new poses again, with a joint that is off by so much more.
  void slip(const std::string& joint, double by) {
    offsets_[joint] += by;
    fresh = measured(std::move(fresh));
  }
  /// How far a slip moves the features of new samples: see slip_size().
  [[nodiscard]] double size_of(const std::string& joint, double slip) const {
    const Eigen::VectorXd at = values();
    return slip_size(*problem(fresh), {at.data(), static_cast<std::size_t>(at.size())}, fresh,
                     assessment_.noise[0], joint, slip);
  }
  [[nodiscard]] Drift check(double level) const {
    const Eigen::VectorXd at = values();
    const CalibratedState state =
        calibrated_state(assessment_, {at.data(), static_cast<std::size_t>(at.size())});
    return check_drift(*problem(fresh), fresh, state, {level});
  }
  [[nodiscard]] const Assessment& assessment() const { return assessment_; }

  [[nodiscard]] const AnyProblem& fitted() const { return *calibration_.steps[0].problem; }
  [[nodiscard]] const FreeSet& free() const { return calibration_.steps[0].free; }
  [[nodiscard]] const std::vector<Sample>& calibrated() const { return old_; }
  [[nodiscard]] Eigen::VectorXd values() const { return result_.table.values(); }

  std::vector<Sample> fresh;  ///< the new samples

 private:
  [[nodiscard]] Vector3<double> vector() {
    const double x = normal_(random_), y = normal_(random_), z = normal_(random_);
    return {x, y, z};
  }
  [[nodiscard]] ParameterTable table() const {
    ParameterTable all;
    for (const std::string& name : joint_names()) all.add({.name = name});
    for (const char* frame : {"tracker", "tool"}) {
      for (const auto axis : kFrameAxes) {
        const std::string name = parameter_name(frame, axis);
        const bool length = name.back() >= 'x';
        all.add({.name = name, .unit = length ? "m" : "rad"});
      }
    }
    return all;
  }
  [[nodiscard]] FreeSet free_of_table() const {
    std::vector<int> numbers;
    const ParameterTable all = table();
    for (int p = 0; p < all.size(); ++p) {
      const std::string& name = all[p].name;
      const bool turns_with_last =
          kind_.points < 3 && name.starts_with("tool") && all[p].unit == "rad";
      if (name == "joint_1" || name == joint_names().back() || turns_with_last) continue;
      numbers.push_back(p);
    }
    return FreeSet(std::move(numbers), all.size());
  }
  [[nodiscard]] std::unique_ptr<AnyProblem> problem(const std::vector<Sample>& with) const {
    auto all = make_problem(model_, "base_link", table(), {"tracker", "tool"});
    all->add_built_in(ChainPoint{}, {"arm", "tool_link"});
    all->add_built_in(ChainPoint{}, {"seen", "tracker_link"});
    all->add_built_in("measured", PointToPoint{}, {"arm", "seen"}, {});
    for (const Sample& sample : with) all->add_sample(sample);
    return all;
  }
  /// Poses of the arm, of which nothing is measured yet.
  [[nodiscard]] std::vector<Sample> poses(int count) {
    std::uniform_real_distribution<double> within(-1.4, 1.4);
    std::vector<Sample> samples;
    for (int n = 0; n < count; ++n) {
      Sample& sample = samples.emplace_back();
      sample.source = "arm:" + std::to_string(n);
      sample.joint_names = joint_names();
      for (int i = 0; i < kind_.axes; ++i) sample.joint_positions.push_back(within(random_));
    }
    return samples;
  }
  /// The same poses, measured.
  [[nodiscard]] std::vector<Sample> measured(std::vector<Sample> samples) {
    const RuntimeChain arm = make_chain(robot_, "base_link", "tool_link");
    const Pose<double> tracker_T_base = forward_kinematics(
        make_chain(robot_, "tracker_link", "base_link"), [](const std::string&) { return 0.0; });
    const Vector3<double> points[] = {{0.0, 0.0, 0.03}, {0.07, 0.02, 0.0}, {-0.01, -0.06, 0.02}};
    for (Sample& sample : samples) {
      const Pose<double> tip =
          tracker_T_base * forward_kinematics(arm, [&](const std::string& name) {
            const double q = *sample.position(name);
            return q + offsets_.at(name) + kind_.gears * std::sin(q + phases_.at(name)) +
                   kind_.repeats * normal_(random_);
          });
      Observation held{"arm", {}}, seen{"seen", {}};
      for (int k = 0; k < kind_.points; ++k) {
        const Vector3<double> point = points[k], error = kind_.noise * vector();
        held.features.push_back({"tool_link", points[k]});
        seen.features.push_back({"tracker_link", tip * point + error});
      }
      sample.observations = {held, seen};
    }
    return samples;
  }

  ArmKind kind_;
  Robot model_, robot_;
  std::map<std::string, double> offsets_, phases_;  ///< of joints, and of their gears
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<Sample> old_;
  Calibration calibration_;
  CalibrationResult result_;
  Assessment assessment_;
};

}  // namespace kinecal::test
