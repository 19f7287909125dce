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
  if (block.type == PoseToPose::kType) return Contact::grip;
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

/// Known places of sockets that a configuration does not have: such as show the axes of their frame that are free.
[[nodiscard]] std::vector<Vector3<double>> layout_of(const FreeFrameConfig& frame) {
  constexpr double kApart = 0.1;  // metres
  std::vector<Vector3<double>> layout = {Vector3<double>::Zero(), {kApart, 0.0, 0.0}};
  if (frame.axes[3]) layout.emplace_back(kApart, kApart, 0.0);
  return layout;
}

/// Where a fixed frame is, metres.
[[nodiscard]] Vector3<double> fixed_place(const FreeFrameConfig& frame, const StepConfig& step) {
  Vector3<double> place = Vector3<double>::Zero();
  for (const InitialValueConfig& value : step.initial_values) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (value.name == parameter_name(frame.name, kFrameAxes[static_cast<std::size_t>(k)]))
        place(k) = value.value;
    }
  }
  return place;
}

/// Both hands of a robot hold one thing: the only frame is that of one hand in the other.
[[nodiscard]] std::optional<ConfiguredTouch> configured_grip(
    const Config& config, const BlockConfig& block, const std::vector<std::string>& links) {
  const std::vector<FreeFrameConfig>& frames = config.steps.back().free_frames;
  if (frames.size() != 1 || links.front() == links.back()) return std::nullopt;
  const std::string& grip = frames.front().name;
  ConfiguredTouch touch{.target = {config.base_link, links.front(), links.back()},
                        .held = block.models.front(),
                        .touched = block.models.back(),
                        .tip = links.front(),
                        .places = {grip}};
  touch.target.sensor_frame = grip;
  touch.target.contact = Contact::grip;
  return touch;
}

/// The links of the chains that a block compares; empty if it compares something else.
[[nodiscard]] std::vector<std::string> links_of(const BlockConfig& block, const StepConfig& step) {
  std::vector<std::string> links;
  for (const std::string& name : block.models) {
    for (const ModelConfig& model : step.models) {
      if (model.name == name && model.type.starts_with("chain")) links.push_back(model.frame);
    }
  }
  return links.size() == block.models.size() ? links : std::vector<std::string>{};
}

/// Several arms that touch the same points: the last frames are those of their tips, as `init` writes them.
/// @param blocks  of each arm
[[nodiscard]] std::optional<ConfiguredTouch> configured_arms(
    const Config& config, const std::vector<const BlockConfig*>& blocks) {
  Config of_one = config;
  StepConfig& step = of_one.steps.back();
  std::vector<FreeFrameConfig> frames = step.free_frames;
  if (frames.size() <= blocks.size()) return std::nullopt;
  std::stable_partition(frames.begin(), frames.end(),
                        [](const FreeFrameConfig& frame) { return frame.is_fixed; });
  const auto tips = frames.end() - static_cast<std::ptrdiff_t>(blocks.size());
  step.free_frames.assign(frames.begin(), tips + 1);
  step.error_blocks = {*blocks.front()};
  std::optional<ConfiguredTouch> touch = configured_touch(of_one);
  if (!touch || touch->target.contact != Contact::point) return std::nullopt;
  for (std::size_t i = 1; i < blocks.size(); ++i) {
    const BlockConfig& block = *blocks[i];
    const FreeFrameConfig& tip = *(tips + static_cast<std::ptrdiff_t>(i));
    const std::vector<std::string> links = links_of(block, step);
    const bool is_same = contact_of(block) == Contact::point && !links.empty() &&
                         block.models.back() == touch->touched && !turns(tip);
    if (!is_same) return std::nullopt;
    touch->more_held.push_back(block.models.front());
    touch->target.more_tips.push_back({links.front(), tip.name});
  }
  return touch;
}

}  // namespace
}  // namespace detail

std::optional<ConfiguredTouch> configured_touch(const Config& config) {
  if (config.steps.empty()) return std::nullopt;
  const StepConfig& step = config.steps.back();
  std::vector<const BlockConfig*> blocks;  // of each arm
  for (const BlockConfig& one : step.error_blocks) {
    if (one.param.empty()) blocks.push_back(&one);  // no prior
  }
  if (blocks.empty()) return std::nullopt;
  const BlockConfig* const block = blocks.front();
  ConfiguredTouch touch;
  touch.target.contact = detail::contact_of(*block);
  if (touch.target.contact == Contact::none) return std::nullopt;
  const std::vector<std::string> links = detail::links_of(*block, step);
  if (links.empty() || step.free_frames.empty()) return std::nullopt;
  if (blocks.size() > 1) return detail::configured_arms(config, blocks);
  if (touch.target.contact == Contact::grip) return detail::configured_grip(config, *block, links);
  const FreeFrameConfig& tip = detail::frame_of_tip(step.free_frames);
  bool is_known = false;
  for (const FreeFrameConfig& frame : step.free_frames) {
    if (&frame == &tip) continue;
    touch.places.push_back(frame.name);
    is_known = is_known || frame.is_fixed;
    if (frame.is_fixed) touch.target.layout = {detail::fixed_place(frame, step)};
    if (touch.target.contact != Contact::point || !detail::turns(frame)) continue;
    // That of sockets at known places turns like a tracker's; 'init' calls what is touched so.
    if (block->models.back() != "touched") return std::nullopt;
    touch.target.layout = detail::layout_of(frame);
  }
  if (touch.target.contact == Contact::point && detail::turns(tip)) return std::nullopt;
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
  if (!is_known) touch.target.sensor_frame = touch.places.front();
  touch.target.places = static_cast<int>(touch.places.size());
  return touch;
}

TouchedSamples touched_samples(const Robot& robot, const ConfiguredTouch& touch, std::size_t count,
                               std::uint64_t seed) {
  const TouchingPoses poses = touching_poses(robot, touch.target, count, seed);
  if (poses.positions.size() < 3) {
    throw InputError(fmt::format(
        "'{}' touches one place in hardly any pose within the joint limits", touch.target.target));
  }
  const RuntimeChain to_tip = make_chain(robot, touch.target.base, touch.target.target);
  const Contact contact = touch.target.contact;
  TouchedSamples made;
  for (std::size_t i = 0; i < poses.positions.size(); ++i) {
    Sample& sample = made.samples.emplace_back();
    sample.source = fmt::format("generated pose {}", i + 1);
    for (const auto& [joint, position] : poses.positions[i]) {
      sample.joint_names.push_back(joint);
      sample.joint_positions.push_back(position);
    }
    // A tip that the URDF has is a link; its joint is free.
    Feature tip{robot.has_joint(touch.tip) ? touch.target.target : touch.tip,
                Vector3<double>::Zero()};
    const std::size_t further = poses.tips[i];
    if (further > 0) tip.frame = touch.target.more_tips[further - 1].frame;
    if (contact == Contact::grip) tip.rotation = Matrix3<double>::Identity();
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
    sample.observations = {{further > 0 ? touch.more_held[further - 1] : touch.held, {tip}}};
    if (touch.touched.empty()) continue;
    Feature place{touch.places[i % touch.places.size()], Vector3<double>::Zero()};
    const std::vector<Vector3<double>>& layout = touch.target.layout;
    const bool is_known = touch.target.sensor_frame.empty();  // its frame is where the point is
    if (!layout.empty() && !is_known) place.point = layout[i % layout.size()];
    const bool has_direction =
        contact == Contact::plane || contact == Contact::line || contact == Contact::grip;
    if (has_direction) place.rotation = Matrix3<double>::Identity();
    sample.observations.push_back({touch.touched, {place}});
  }
  if (contact == Contact::grip) {
    const Pose<double>& grip = poses.sensor_T_touched;
    Eigen::Matrix<double, 6, 1> numbers;
    numbers << grip.translation, log(grip.rotation);
    for (std::size_t k = 0; k < kFrameAxes.size(); ++k) {
      made.values.add({.name = parameter_name(touch.places.front(), kFrameAxes[k]),
                       .value = numbers(static_cast<Eigen::Index>(k))});
    }
  }
  return made;
}

}  // namespace kinecal
