// Where the cameras of a rig stand, by samples that they share: for start_cameras.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/cameras/target_pairs.ipp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/problem/sampled_chain.hpp"

namespace kinecal::detail {

/// A camera with the poses of a target in it, by sample.
struct SeenTarget {
  TargetPair pair;
  std::map<std::size_t, Pose<double>> poses;  ///< camera_T_target
};

/// Where one camera stood in another, by each sample that shows a target to both.
/// @param offset  number of samples by which the second one's images come later
[[nodiscard]] inline std::vector<Pose<double>> places_in(const SeenTarget& a, const SeenTarget& b,
                                                         long offset = 0) {
  std::vector<Pose<double>> places;
  if (a.pair.joint != b.pair.joint) return places;
  for (const auto& [s, in_a] : a.poses) {
    const auto in_b = b.poses.find(s + static_cast<std::size_t>(offset));
    if (in_b != b.poses.end()) places.push_back(in_a * in_b->second.inverse());
  }
  return places;
}

/// The pose with the smallest sum of distances to the others; nullopt of none.
[[nodiscard]] inline std::optional<Pose<double>> middle_of(const std::vector<Pose<double>>& all) {
  const auto distance = [](const Pose<double>& x, const Pose<double>& y) {
    return (x.translation - y.translation).norm() +
           log(Matrix3<double>(x.rotation.transpose() * y.rotation)).norm();
  };
  std::optional<Pose<double>> best;
  double least = HUGE_VAL;
  for (const Pose<double>& one : all) {
    double sum = 0.0;
    for (const Pose<double>& other : all) sum += distance(one, other);
    if (sum >= least) continue;
    least = sum;
    best = one;
  }
  return best;
}

/// base_T_link in a sample, without corrections; nullopt if the sample lacks a joint.
[[nodiscard]] inline std::optional<Pose<double>> pose_of_link(const Config& config,
                                                              const Robot& robot,
                                                              const std::string& link,
                                                              const Sample& sample) {
  const SampledChain chain(robot, make_chain(robot, config.base_link, link), ParameterTable{});
  if (!chain.has_joints(sample)) return std::nullopt;
  return chain.tip(sample, Corrections<double>(chain.chain().joints.size()));
}

/// The robot whose joints' frames begin where the configuration says; floating ones stay, because their frames are
/// beyond what was measured.
[[nodiscard]] inline Robot at_initial_values(const Config& config, const Robot& robot) {
  std::vector<Joint> joints = robot.joints();
  const StepConfig& step = config.steps.front();
  for (const FrameInitialValueConfig& value : step.frame_initial_values) {
    const auto joint = std::find_if(joints.begin(), joints.end(),
                                    [&](const Joint& one) { return one.name == value.name; });
    const auto frame = std::find_if(step.free_frames.begin(), step.free_frames.end(),
                                    [&](const auto& one) { return one.name == value.name; });
    if (joint == joints.end() || joint->type == JointType::floating) continue;
    if (frame == step.free_frames.end()) continue;
    Vector3<double> shift = value.xyz, turn = log(rotation_from_rpy(value.rpy));
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (!frame->axes[static_cast<std::size_t>(axis)]) shift(axis) = 0.0;
      if (!frame->axes[static_cast<std::size_t>(axis) + 3]) turn(axis) = 0.0;
    }
    joint->origin = joint->origin * Pose<double>{exp(turn), shift};
  }
  return Robot(robot.name(), std::move(joints));
}

/// True if a camera stands on the base by a fixed joint whose whole frame is free without an initial value.
[[nodiscard]] inline bool is_placed_by_us(const Config& config, const Robot& robot,
                                          const ModelConfig& camera) {
  const Joint* joint = robot.has_link(camera.frame) ? robot.parent_joint(camera.frame) : nullptr;
  if (joint == nullptr || joint->type != JointType::fixed || joint->parent != config.base_link) {
    return false;
  }
  bool free = false;
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& frame : step.free_frames) {
      const bool whole =
          std::all_of(frame.axes.begin(), frame.axes.end(), [](bool f) { return f; });
      free = free || (frame.name == joint->name && whole);
    }
    for (const FrameInitialValueConfig& value : step.frame_initial_values) {
      if (value.name == joint->name) return false;
    }
  }
  return free;
}

/// base_T_camera of each camera that is fixed to the base, as far as the robot, or samples that it shares with a camera that
/// is known, say.
[[nodiscard]] inline std::map<std::string, Pose<double>> place_cameras(
    Config& config, const Robot& robot, const std::vector<SeenTarget>& seen) {
  std::map<std::string, Pose<double>> known;
  std::vector<const SeenTarget*> open;
  for (const SeenTarget& of : seen) {
    const ModelConfig& camera = *of.pair.camera;
    if (is_placed_by_us(config, robot, camera)) {
      open.push_back(&of);
    } else if (const RuntimeChain chain = make_chain(robot, config.base_link, camera.frame);
               chain.joints.empty()) {
      known.emplace(camera.name, chain.tail);
    }
  }
  for (bool found = true; found;) {
    found = false;
    for (const SeenTarget& of : seen) {
      const auto at = known.find(of.pair.camera->name);
      if (at == known.end()) continue;
      for (const SeenTarget* next : open) {
        const auto a_T_b = middle_of(places_in(of, *next));
        if (!a_T_b || known.contains(next->pair.camera->name)) continue;
        const Pose<double> base_T_camera = at->second * *a_T_b;
        known.emplace(next->pair.camera->name, base_T_camera);
        const Joint& joint = *robot.parent_joint(next->pair.camera->frame);
        const Pose<double> frame = joint.origin.inverse() * base_T_camera;
        config.steps.front().frame_initial_values.push_back(
            {joint.name, frame.translation, rpy_from_rotation(frame.rotation), config.place});
        found = true;
      }
    }
  }
  return known;
}

}  // namespace kinecal::detail
