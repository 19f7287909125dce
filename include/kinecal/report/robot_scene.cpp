// Building the scene of a calibration.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/robot_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/report/left_out.ipp"
#include "kinecal/report/scene_features.ipp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal {

namespace detail {
namespace {

// Floating joints in a scene.

/// True for a floating joint that moves a sensor or target, so that the samples have its pose.
[[nodiscard]] bool is_measured(const AnyProblem& problem, const Joint& joint) {
  const auto is_part = [&](const ChainJoint& part) { return part.floating == joint.name; };
  if (joint.type != JointType::floating) return false;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      const auto& joints = chain.chain().joints;
      if (std::any_of(joints.begin(), joints.end(), is_part)) return true;
    }
  }
  return false;
}

/// A coordinate of a floating joint, without links and drive; nothing is drawn between its links.
[[nodiscard]] SceneJoint scene_coordinate(const Joint& joint, std::size_t i) {
  SceneJoint shown;
  const bool slides = i < 3;
  shown.name = joint.name;
  shown.type = slides ? JointType::prismatic : JointType::continuous;
  if (i == 0) shown.origin = joint.origin;
  shown.axis = {};
  shown.axis[slides ? i : 5 - i] = 1.0;
  shown.is_virtual = true;
  return shown;
}

// The robot of a scene: links, joints, virtual frames and cameras.

/// Adds links, joints and cameras to a scene.
class SceneRobot {
 public:
  SceneRobot(const AnyProblem& problem, const ParameterTable& table, RobotScene& scene)
      : problem_(problem), table_(table), scene_(scene) {
    for (const std::string& link : problem.robot().link_names()) add_link(link);
    scene_.base = links_.at(problem.base());
    for (const Joint& joint : problem.robot().joints()) add_joint(joint);
  }

  /// Adds the frames beyond a link that contain features of the samples.
  void add_frames(std::span<const Sample> samples) {
    std::set<std::pair<std::string, std::string>> known;
    for (const Sample& sample : samples) {
      for (const MountedSensor& sensor : problem_.sensors()) {
        const Observation* seen =
            sensor.sensor().in_own_frame() ? nullptr : sample.observation(sensor.mount().name);
        if (seen == nullptr) continue;
        const std::string* last = nullptr;  // most features have the frame of the previous one
        for (const Feature& feature : seen->features) {
          if (last != nullptr && *last == feature.frame) continue;
          last = &feature.frame;
          const std::string* frame = frame_among(problem_.frames(), feature.frame);
          const bool beyond = frame != nullptr && !problem_.robot().has_joint(*frame);
          if (beyond && known.insert({sensor.mount().frame, *frame}).second) {
            add_frame(sensor.mount().frame, *frame);
          }
        }
      }
    }
  }

  /// Adds the cameras with their settings in the first sample that has them.
  void add_cameras(std::span<const Sample> samples) {
    for (const MountedSensor& sensor : problem_.sensors()) {
      if (!sensor.sensor().is_camera()) continue;
      for (const Sample& sample : samples) {
        const Observation* seen = sample.observation(sensor.mount().name);
        if (seen != nullptr && seen->camera && add_camera(sensor, *seen)) break;
      }
    }
  }

 private:
  int add_link(const std::string& name) {
    std::string unique = name;
    for (int n = 2; links_.contains(unique); ++n) unique = name + " (" + std::to_string(n) + ")";
    links_.emplace(unique, static_cast<int>(scene_.links.size()));
    scene_.links.push_back({unique});
    return static_cast<int>(scene_.links.size()) - 1;
  }

  /// A floating joint as its coordinates, with links between that have no names.
  void add_floating(const Joint& joint) {
    int parent = links_.at(joint.parent);
    for (std::size_t i = 0; i < kFloatingCoordinates.size(); ++i) {
      SceneJoint shown = scene_coordinate(joint, i);
      shown.parent = parent;
      shown.child = i + 1 < kFloatingCoordinates.size() ? add_link("") : links_.at(joint.child);
      shown.drive = position_of(floating_coordinate(joint.name, i));
      parent = shown.child;
      scene_.joints.push_back(std::move(shown));
    }
  }

  void add_joint(const Joint& joint) {
    if (is_measured(problem_, joint)) return add_floating(joint);
    SceneJoint shown{.name = joint.name,
                     .type = joint.type,
                     .parent = links_.at(joint.parent),
                     .child = links_.at(joint.child),
                     .origin = joint.origin,
                     .axis = {joint.axis.x(), joint.axis.y(), joint.axis.z()}};
    const Mimic by = drive(problem_.robot(), joint);
    if (moves(joint.type)) {
      shown.drive = position_of(by.joint);
      shown.multiplier = by.multiplier;
      shown.offset = by.offset;
    }
    ChainJoint corrected;
    corrected.name = joint.name;
    corrected.type = joint.type;
    corrected.corrected = problem_.frames().contains(joint.name);
    corrected.drive = by;
    add_corrections(corrected, shown);
  }

  void add_frame(const std::string& link, const std::string& frame) {
    const int parent = links_.at(link);
    SceneJoint shown;
    shown.name = frame;
    shown.parent = parent;
    shown.child = add_link(frame);
    shown.is_virtual = true;
    ChainJoint corrected;
    corrected.name = frame;
    corrected.corrected = true;
    add_corrections(corrected, shown);
  }

  /// Adds the joint with its corrections.
  void add_corrections(const ChainJoint& joint, SceneJoint& shown) {
    const OffsetAndFrame indices =
        joint_indices(joint, [&](std::string_view owner, std::string_view part) {
          return table_.find(part.empty() ? std::string(owner) : parameter_name(owner, part));
        });
    const auto correction = [&](double Parameter::*value) {
      SceneCorrection of;
      const auto get = [&](int i) { return i < 0 ? 0.0 : table_[i].*value; };
      for (std::size_t k = 0; k < 3; ++k) {
        of.t[k] = get(indices.frame[k]);
        of.r[k] = get(indices.frame[k + 3]);
      }
      of.offset = get(indices.offset) * indices.gain;
      return of;
    };
    const auto has = [](const auto& all) {
      return std::any_of(all.begin(), all.end(), [](int i) { return i >= 0; });
    };
    if (indices.offset >= 0 || has(indices.frame)) {
      shown.before = correction(&Parameter::initial);
      shown.after = correction(&Parameter::value);
    }
    scene_.joints.push_back(std::move(shown));
  }

  [[nodiscard]] int position_of(const std::string& joint) {
    auto& names = scene_.names;
    const auto found = std::find(names.begin(), names.end(), joint);
    const auto place = static_cast<int>(found - names.begin());
    if (found == names.end()) names.push_back(joint);
    return place;
  }

  bool add_camera(const MountedSensor& sensor, const Observation& seen) {
    try {
      const std::vector<double> s = sensor.sensor().settings(seen);
      const auto corrected = [&](std::size_t i) {
        const int parameter = sensor.parameters()[i];
        return s[i] * (1.0 + (parameter < 0 ? 0.0 : table_[parameter].value));
      };
      SceneCamera shown{.name = sensor.mount().name,
                        .link = links_.at(sensor.mount().frame),
                        .width = static_cast<double>(seen.camera->width),
                        .height = static_cast<double>(seen.camera->height),
                        .fx = corrected(0),
                        .fy = corrected(1),
                        .cx = corrected(2),
                        .cy = corrected(3)};
      if (!(shown.width > 0.0)) shown.width = 2.0 * shown.cx;  // not recorded
      if (!(shown.height > 0.0)) shown.height = 2.0 * shown.cy;
      scene_.cameras.push_back(std::move(shown));
      return true;
    } catch (const SettingsError&) {
      return false;
    }
  }

  const AnyProblem& problem_;
  const ParameterTable& table_;
  RobotScene& scene_;
  std::map<std::string, int> links_;
};

/// The robot of a problem, without samples.
[[nodiscard]] RobotScene scene_of_robot(const AnyProblem& problem, const ParameterTable& table,
                                        std::span<const Sample> samples) {
  RobotScene scene;
  SceneRobot robot(problem, table, scene);
  robot.add_frames(samples);
  robot.add_cameras(samples);
  for (int t = 0; t < problem.num_terms(); ++t) scene.blocks.push_back(problem.term(t).name);
  return scene;
}

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
