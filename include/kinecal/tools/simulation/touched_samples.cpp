// Definitions of touched_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/simulation/touched_samples.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kinecal/errors.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The contact that an error block stands for; none: another comparison.
[[nodiscard]] Contact contact_of(const BlockConfig& block) {
  if (block.type == PointOnPlane::kType) return Contact::plane;
  if (block.type == PointOnLine::kType) return Contact::line;
  if (block.type == PointDistance::kType) return Contact::sphere;
  if (block.type == GravitySeen::kType) return Contact::gravity;
  return block.type == PointToPoint::kType ? Contact::point : Contact::none;
}

/// The frame of the tip: the last one that is free in x, y and z; a plane or a line is not.  Of an accelerometer, the only one.
[[nodiscard]] const FreeFrameConfig& frame_of_tip(const std::vector<FreeFrameConfig>& frames) {
  const auto tip = std::find_if(frames.rbegin(), frames.rend(), [](const FreeFrameConfig& frame) {
    return frame.axes[0] && frame.axes[1] && frame.axes[2];
  });
  return tip == frames.rend() ? frames.back() : *tip;
}

[[nodiscard]] bool turns(const FreeFrameConfig& frame) {
  return frame.axes[3] || frame.axes[4] || frame.axes[5];
}

}  // namespace
}  // namespace detail

std::optional<ConfiguredTouch> configured_touch(const Config& config) {
  if (config.steps.empty()) return std::nullopt;
  const StepConfig& step = config.steps.back();
  const BlockConfig* block = nullptr;
  for (const BlockConfig& one : step.error_blocks) {
    if (!one.param.empty()) continue;  // a prior
    if (block != nullptr) return std::nullopt;
    block = &one;
  }
  if (block == nullptr) return std::nullopt;
  ConfiguredTouch touch;
  touch.target.contact = detail::contact_of(*block);
  if (touch.target.contact == Contact::none) return std::nullopt;
  std::vector<std::string> links;
  for (const std::string& name : block->models) {
    for (const ModelConfig& model : step.models) {
      if (model.name == name && model.type.starts_with("chain")) links.push_back(model.frame);
    }
  }
  if (links.size() != block->models.size() || step.free_frames.empty()) return std::nullopt;
  const FreeFrameConfig& tip = detail::frame_of_tip(step.free_frames);
  for (const FreeFrameConfig& frame : step.free_frames) {
    // A tracker's frame turns, that of a point does not.
    if (touch.target.contact == Contact::point && detail::turns(frame)) return std::nullopt;
    if (&frame != &tip) touch.places.push_back(frame.name);
  }
  touch.held = block->models.front();
  touch.tip = tip.name;
  touch.target.base = config.base_link;
  touch.target.target = links.front();
  touch.target.target_frame = tip.name;
  touch.target.is_point = !detail::turns(tip) || touch.target.contact == Contact::gravity;
  touch.target.sensor = config.base_link;
  if (touch.target.contact == Contact::gravity) return touch;
  if (touch.places.empty()) return std::nullopt;
  touch.touched = block->models.back();
  touch.target.sensor = links.back();
  touch.target.sensor_frame = touch.places.front();
  touch.target.places = static_cast<int>(touch.places.size());
  return touch;
}

std::vector<Sample> touched_samples(const Robot& robot, const ConfiguredTouch& touch,
                                    std::size_t count, std::uint64_t seed) {
  const TouchingPoses poses = touching_poses(robot, touch.target, count, seed);
  if (poses.positions.size() < 3) {
    throw InputError(fmt::format(
        "'{}' touches one place in hardly any pose within the joint limits", touch.target.target));
  }
  const RuntimeChain to_tip = make_chain(robot, touch.target.base, touch.target.target);
  const Contact contact = touch.target.contact;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < poses.positions.size(); ++i) {
    Sample& sample = samples.emplace_back();
    sample.source = fmt::format("generated pose {}", i + 1);
    for (const auto& [joint, position] : poses.positions[i]) {
      sample.joint_names.push_back(joint);
      sample.joint_positions.push_back(position);
    }
    // A tip that the URDF has is a link; its joint is free.
    Feature tip{robot.has_joint(touch.tip) ? touch.target.target : touch.tip,
                Vector3<double>::Zero()};
    if (contact == Contact::gravity) {
      tip.rotation = Matrix3<double>::Identity();
      const Pose<double> hand = forward_kinematics(
          to_tip, [&](const std::string& joint) { return poses.positions[i].at(joint); });
      constexpr double kGravity = 9.80665;
      for (int k = 0; k < 3; ++k) {
        sample.conditions[std::string("a") + "xyz"[k]] = kGravity * hand.rotation(2, k);
      }
    }
    if (!poses.distances.empty()) tip.point.z() = poses.distances[i];
    sample.observations = {{touch.held, {tip}}};
    if (touch.touched.empty()) continue;
    Feature place{touch.places[i % touch.places.size()], Vector3<double>::Zero()};
    const bool has_direction = contact == Contact::plane || contact == Contact::line;
    if (has_direction) place.rotation = Matrix3<double>::Identity();
    sample.observations.push_back({touch.touched, {place}});
  }
  return samples;
}

}  // namespace kinecal
