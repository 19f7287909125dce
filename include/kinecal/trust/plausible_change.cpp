// Definitions of plausible_change.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/plausible_change.hpp"

#include <algorithm>
#include <numbers>
#include <string>

namespace kinecal::detail {

Grade Limits::grade(double figure) const {
  return !(figure < refuse) ? Grade::do_not_use : Grade::use_with_care;
}

Grade Limits::judged(double figure) const {
  return exceeded(figure) ? grade(figure) : Grade::good;
}

double robot_size(const AnyProblem& problem) {
  constexpr double kArm = 1.0;
  const std::vector<std::string>& own = problem.sample_poses();
  const auto is_reported = [&](const ChainJoint& joint) {
    return !joint.floating.empty() &&
           std::find(own.begin(), own.end(), joint.floating) == own.end();
  };
  double longest = 0.0;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      const std::vector<ChainJoint>& joints = chain.chain().joints;
      double length = chain.chain().tail.translation.norm();
      if (std::any_of(joints.begin(), joints.end(), is_reported)) length += kArm;
      for (const ChainJoint& joint : joints) length += joint.fixed.translation.norm();
      longest = std::max(longest, length);
    }
  }
  return longest;
}

Limits plausible_length_change(const AnyProblem& problem, const Joint& joint) {
  constexpr double kMost = 0.05, kOfLink = 0.15, kOfRobot = 0.03, kRefused = 6.0;
  const double length = kOfLink * joint.origin.translation.norm();
  const double care = std::min(kMost, std::max(length, kOfRobot * robot_size(problem)));
  return {care, kRefused * kMost};
}

namespace {

/// True for the name of an error block, which owns parameters of its own: the center of a sphere.
[[nodiscard]] bool is_of_block(const AnyProblem& problem, const std::string& owner) {
  for (int t = 0; t < problem.num_terms(); ++t) {
    if (problem.term(t).name == owner) return true;
  }
  return false;
}

}  // namespace

bool is_unknown_lens(const AnyProblem& problem, int parameter) {
  const std::size_t first = problem.sample_poses().empty() ? kIntrinsics : 0;
  return std::any_of(problem.sensors().begin(), problem.sensors().end(), [&](const auto& sensor) {
    const std::vector<int>& own = sensor.parameters();
    const auto from = own.begin() + static_cast<std::ptrdiff_t>(std::min(first, own.size()));
    return sensor.sensor().delivers(Quantity::pixel) &&
           std::find(from, own.end(), parameter) != own.end();
  });
}

Limits plausible_change(const AnyProblem& problem, int parameter) {
  constexpr double kNever = 1e300, kDegree = std::numbers::pi / 180.0;
  const Parameter& p = problem.table()[parameter];
  const std::string& owner = problem.owners()[static_cast<std::size_t>(parameter)];
  if (p.name == owner && problem.robot().has_joint(owner)) {
    if (p.unit == "m") return {0.1, 0.5};
    return {15.0 * kDegree, 45.0 * kDegree};
  }
  if (problem.robot().has_joint(owner)) {
    if (p.unit == "rad/Nm") return {1e-3, 1e-2};  // of joint models: a servo yields by 1e-3
    if (p.unit == "m/N") return {1e-5, 1e-4};
    if (p.unit.ends_with("kg/Nm") || p.unit.ends_with("kg/N")) return {1e-2, 1e-1};
    const Joint& joint = problem.robot().joint(owner);
    const bool moving = moves(joint.type);
    if (p.unit == "m") return moving ? plausible_length_change(problem, joint) : Limits{0.2, 1.0};
    return moving ? Limits{15.0 * kDegree, 60.0 * kDegree} : Limits{30.0 * kDegree, kNever};
  }
  if (problem.frames().contains(owner) || is_unknown_lens(problem, parameter)) {
    return {kNever, kNever};
  }
  if (p.unit == "m") {
    const bool is_given = p.initial != 0.0 || !is_of_block(problem, owner);
    return {is_given ? 0.1 : kNever, kNever};
  }
  if (p.unit == "s") return {0.2, 1.0};                      // the lag of a sensor
  if (p.name.ends_with("_z_quadratic")) return {0.09, 0.3};  // of depth, at a metre
  return p.unit == "1" ? Limits{0.09, 0.3} : Limits{kNever, kNever};
}

bool is_never_negative(const AnyProblem& problem, int parameter) {
  const auto of = joint_model_parameter(problem.robot(), problem.table()[parameter].name);
  return of && of->model->is_never_negative();
}

Limits plausible_change(const CalibrationStep& step, int parameter) {
  constexpr double kNever = 1e300;
  const std::string& owner = step.problem->owners()[static_cast<std::size_t>(parameter)];
  const bool searched = std::any_of(
      step.unknown_frames.begin(), step.unknown_frames.end(),
      [&](const UnknownFrame& frame) { return frame.name == owner && !frame.has_guess; });
  return searched ? Limits{kNever, kNever} : plausible_change(*step.problem, parameter);
}

}  // namespace kinecal::detail
