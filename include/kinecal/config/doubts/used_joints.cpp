// Definitions of used_joints.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/used_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "kinecal/config/doubts/joint_limits.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/kinematics/chain.hpp"

namespace kinecal::detail {

/// The limits of a joint if they bound anything.  Many URDFs have 0 and 0, or 1e16, for unknown
/// limits.
[[nodiscard]] inline std::optional<JointLimits> useful_limits(const Joint& joint) {
  constexpr double kMostTurns = 4 * 2 * std::numbers::pi, kMostTravel = 100.0;
  if (!joint.limits || !(joint.limits->lower < joint.limits->upper)) return std::nullopt;
  const double most = turns(joint.type) ? kMostTurns : kMostTravel;
  if (joint.limits->upper - joint.limits->lower > most) return std::nullopt;
  return joint.limits;
}

double UsedJoint::range() const {
  const auto [least, greatest] = std::minmax_element(positions.begin(), positions.end());
  return positions.empty() ? 0.0 : *greatest - *least;
}

std::string UsedJoint::limits_text() const {
  const std::string_view unit = position_unit(joint.type);
  if (limits->lower == -limits->upper) return fmt::format("±{:.4g} {}", limits->upper, unit);
  return fmt::format("[{:.4g}, {:.4g}] {}", limits->lower, limits->upper, unit);
}

std::vector<ModelConfig> models_of(const Config& config) {
  std::vector<ModelConfig> models;
  std::set<std::string> names;
  for (const StepConfig& step : config.steps) {
    for (const ModelConfig& model : step.models) {
      if (names.insert(model.name).second) models.push_back(model);
    }
  }
  return models;
}

std::set<std::string> pixel_models(const Config& config) {
  std::set<std::string> names;
  for (const ModelConfig& model : models_of(config)) {
    const SensorEntry* entry = entry_of(model);
    const bool delivers = entry != nullptr && (entry->sensor->delivers(Quantity::point) ||
                                               entry->sensor->delivers(Quantity::pose));
    if (!delivers) names.insert(model.name);
  }
  return names;
}

std::vector<const Joint*> joints_between(const Config& config, const Robot& robot) {
  std::set<std::string> names;
  if (!robot.has_link(config.base_link)) return {};
  std::set<std::string> above;
  for (const Joint* joint : joints_to_root(robot, config.base_link)) above.insert(joint->name);
  for (const ModelConfig& model : models_of(config)) {
    for (const std::string& frame : model.frames()) {
      if (!robot.has_link(frame)) continue;
      std::set<std::string> way;
      for (const Joint* joint : joints_to_root(robot, frame)) way.insert(joint->name);
      std::set_symmetric_difference(above.begin(), above.end(), way.begin(), way.end(),
                                    std::inserter(names, names.end()));
    }
  }
  std::vector<const Joint*> joints;
  for (const Joint& joint : robot.joints()) {
    if (names.contains(joint.name)) joints.push_back(&joint);
  }
  return joints;
}

std::vector<UsedJoint> used_joints(const Config& config, const Robot& robot,
                                   std::span<const Sample> samples) {
  std::set<std::string> names;
  for (const Joint* joint : joints_between(config, robot)) {
    if (moves(joint->type)) names.insert(drive(robot, *joint).joint);
  }
  std::vector<UsedJoint> used;
  for (const Joint& joint : robot.joints()) {
    if (names.contains(joint.name)) used.push_back({joint, {}, {}, useful_limits(joint)});
  }
  std::vector<std::size_t> at(used.size());  // of each joint in the names of a sample
  const std::vector<std::string>* known = nullptr;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const auto& of_sample = samples[s].joint_names;
    if (known == nullptr || *known != of_sample) {  // most samples have the names of the one before
      known = &of_sample;
      for (std::size_t j = 0; j < used.size(); ++j) {
        const auto found = std::find(of_sample.begin(), of_sample.end(), used[j].joint.name);
        at[j] = static_cast<std::size_t>(found - of_sample.begin());
      }
    }
    for (std::size_t j = 0; j < used.size(); ++j) {
      if (at[j] >= samples[s].joint_positions.size()) continue;
      used[j].positions.push_back(samples[s].joint_positions[at[j]]);
      used[j].samples.push_back(s);
    }
  }
  return used;
}

std::vector<UsedJoint> with_initial_zeros(const Config& config, std::vector<UsedJoint> joints) {
  for (const StepConfig& step : config.steps) {
    for (const InitialValueConfig& zero : step.initial_values) {
      for (UsedJoint& joint : joints) {
        if (joint.joint.name != zero.name) continue;
        UsedJoint moved = joint;
        for (double& position : moved.positions) position += zero.value;
        const auto inside = [&](double position) { return !is_outside(moved, position); };
        if (std::all_of(moved.positions.begin(), moved.positions.end(), inside)) {
          joint = std::move(moved);
        }
      }
    }
  }
  return joints;
}

}  // namespace kinecal::detail
