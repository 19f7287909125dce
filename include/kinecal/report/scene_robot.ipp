// The robot of a scene: links, joints, virtual frames and cameras.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/report/scene_floating.ipp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal::detail {

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
[[nodiscard]] inline RobotScene scene_of_robot(const AnyProblem& problem,
                                               const ParameterTable& table,
                                               std::span<const Sample> samples) {
  RobotScene scene;
  SceneRobot robot(problem, table, scene);
  robot.add_frames(samples);
  robot.add_cameras(samples);
  for (int t = 0; t < problem.num_terms(); ++t) scene.blocks.push_back(problem.term(t).name);
  return scene;
}

}  // namespace kinecal::detail
