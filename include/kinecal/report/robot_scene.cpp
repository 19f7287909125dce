// Building the scene of a calibration.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/robot_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/report/left_out.ipp"
#include "kinecal/report/scene_features.ipp"
#include "kinecal/report/scene_robot.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The problem solved last; nullptr if absent.
[[nodiscard]] const CalibrationStep* last_step(const Calibration& calibration,
                                               const CalibrationResult& result) {
  if (calibration.steps.empty()) return nullptr;
  const std::size_t ran = std::max<std::size_t>(1, result.steps.size());
  return &calibration.steps[std::min(ran, calibration.steps.size()) - 1];
}

/// Indices of the samples to show, ascending: bad ones, worst ones, others evenly.
[[nodiscard]] std::vector<std::size_t> shown_samples(const Findings& findings, std::size_t all,
                                                     std::size_t most) {
  std::vector<std::size_t> chosen;
  std::vector<bool> taken(all, all <= most);
  std::size_t left = most;
  if (all > most && !findings.assessments.empty()) {
    std::vector<CaptureError> captures = findings.assessments.back().captures;
    std::stable_sort(captures.begin(), captures.end(), [](const auto& a, const auto& b) {
      return std::pair(a.bad, a.times) > std::pair(b.bad, b.times);
    });
    for (std::size_t i = 0; i < captures.size() && left > most / 2; ++i) {
      const auto sample = static_cast<std::size_t>(captures[i].sample);
      if ((i >= most / 10 && !captures[i].bad) || sample >= all || taken[sample]) continue;
      taken[sample] = true;
      --left;
    }
  }
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < all; ++i) {
    if (!taken[i]) others.push_back(i);
  }
  for (std::size_t i = 0; i < left && all > most; ++i)
    taken[others[i * others.size() / left]] = true;
  for (std::size_t i = 0; i < all; ++i) {
    if (taken[i]) chosen.push_back(i);
  }
  return chosen;
}

/// Marks a sample as left out.
void mark_left_out(const LeftOutSample& left, SceneSample& shown) {
  shown.number = left.number;
  shown.bad = shown.left_out = true;
  shown.note = left.why;
}

/// Number, source location, joint positions and fault, without features.
/// @param i     index among those used, then those left out
/// @param used  number of the former
[[nodiscard]] SceneSample scene_sample(const RobotScene& scene, const Findings& findings,
                                       const Sample& sample, std::size_t i, std::size_t used) {
  SceneSample shown{
      .number = i < findings.numbers.size() ? findings.numbers[i] : static_cast<int>(i) + 1,
      .source = sample.source,
      .bad = false,
      .left_out = false,
      .note = {},
      .q = {},
      .features = {},
      .stamp = sample.stamp};
  for (const std::string& name : scene.names) {
    const double q = sample.position(name).value_or(0.0);
    shown.q.push_back(std::isfinite(q) ? q : 0.0);
  }
  if (i >= used) mark_left_out(findings.left_out[i - used], shown);
  if (i >= used || findings.assessments.empty()) return shown;
  const Assessment& last = findings.assessments.back();
  const auto error = std::find_if(
      last.captures.begin(), last.captures.end(),
      [i](const CaptureError& of) { return of.bad && static_cast<std::size_t>(of.sample) == i; });
  if (error == last.captures.end()) return shown;
  shown.bad = true;
  shown.note = capture_text(*error, last) + cause_text(findings, static_cast<int>(i));
  return shown;
}

}  // namespace
}  // namespace detail

RobotScene robot_scene(const Calibration& calibration, const Findings& findings,
                       std::span<const Sample> samples, const SceneLimits& limits,
                       std::span<const Sample> left_out) {
  const CalibrationStep* step = detail::last_step(calibration, findings.result);
  if (step == nullptr) return {};
  const std::size_t used = samples.size(), of_left = std::min(left_out.size(), limits.samples / 2);
  const detail::ProblemWithLeftOut all(*step->problem, samples, left_out.first(of_left));
  RobotScene scene = detail::scene_of_robot(all.problem(), findings.result.table, all.samples());
  scene.robot = findings.robot;
  std::vector<std::size_t> shown = detail::shown_samples(findings, used, limits.samples - of_left);
  for (std::size_t i = 0; i < of_left; ++i) shown.push_back(used + i);
  if (shown.size() < used + left_out.size()) {
    scene.thinned = fmt::format("{} of {} samples", shown.size(), used + left_out.size());
  }
  for (const std::size_t i : shown) {
    scene.samples.push_back(detail::scene_sample(scene, findings, all.samples()[i], i, used));
  }
  detail::add_features(all.problem(), findings.result.table, all.samples(), shown, limits.features,
                       scene);
  std::stable_sort(scene.samples.begin(), scene.samples.end(),
                   [](const SceneSample& a, const SceneSample& b) { return a.number < b.number; });
  return scene;
}

Pose<double> child_in_parent(const SceneJoint& joint, std::span<const double> q, bool corrected) {
  Pose<double> pose = joint.origin;
  const std::optional<SceneCorrection>& correction = corrected ? joint.after : joint.before;
  if (correction) {
    const auto& [t, r, offset] = *correction;
    pose = pose * Pose<double>{exp(Vector3<double>(r[0], r[1], r[2])), {t[0], t[1], t[2]}};
  }
  if (!moves(joint.type) || joint.drive < 0) return pose;
  const double measured = q[static_cast<std::size_t>(joint.drive)];
  double position = joint.multiplier * measured + joint.offset;
  if (correction) position += correction->offset;
  const Vector3<double> axis(joint.axis[0], joint.axis[1], joint.axis[2]);
  const Vector3<double> along = axis * position;
  return pose * (turns(joint.type) ? Pose<double>{exp(along), Vector3<double>::Zero()}
                                   : Pose<double>{Matrix3<double>::Identity(), along});
}

}  // namespace kinecal
