// Definitions of identified_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/identified_config.hpp"

#include <algorithm>
#include <set>

#include "kinecal/config/registry.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/tools/identify/candidates.ipp"
#include "kinecal/tools/identify/model_candidates.ipp"

namespace kinecal {

Config with_all_candidates(const Config& config, const Robot& robot,
                           std::span<const Sample> samples) {
  Config all = config;
  StepConfig& step = all.steps.front();
  const auto free = [&](const std::string& name) {
    if (!detail::is_free(step, name)) step.free_params.push_back({name, step.place});
  };
  for (const Joint* joint : detail::moving_joints(detail::model_chains(config, robot), robot)) {
    free(joint->name);
    for (std::size_t axis = 0; axis < 6; ++axis) detail::free_axis(step, joint->name, axis);
  }
  for (const detail::HeldMount& mount : detail::held_mounts(config, robot)) {
    for (std::size_t axis = 0; axis < 6; ++axis) detail::free_axis(step, mount.joint, axis);
  }
  for (const detail::ModelCandidate& of_joint : detail::model_candidates(config, robot, samples)) {
    for (const std::string& name : of_joint.parameters) free(name);
  }
  for (const ModelConfig& model : step.models) {
    for (const std::string& name : detail::sensor_parameters(step, model)) free(name);
  }
  for (FreeFrameConfig& frame : step.free_frames) frame.place = step.place;
  return all;
}

namespace detail {
namespace {

/// What is free from the beginning: IdentifyTask::base.
[[nodiscard]] std::vector<int> search_base(const StepConfig& step, const AnyProblem& problem) {
  std::vector<int> base;
  for (const FreeFrameConfig& frame : step.free_frames) {
    if (!is_base_frame(problem.robot(), frame)) continue;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const int p = problem.table().find(parameter_name(frame.name, kFrameAxes[axis]));
      if (frame.axes[axis] && p >= 0) base.push_back(p);
    }
  }
  for (const FreeParamConfig& parameter : step.free_params) {  // those of error blocks
    const int p = problem.table().find(parameter.name);
    if (p < 0) continue;
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    const auto is_block = [&](const BlockConfig& block) { return block.name == owner; };
    if (std::any_of(step.error_blocks.begin(), step.error_blocks.end(), is_block))
      base.push_back(p);
  }
  return base;
}

}  // namespace
}  // namespace detail

IdentifyTask identify_task(const Config& config, const AnyProblem& problem,
                           std::span<const Sample> samples, bool geometry_only) {
  const Robot& robot = problem.robot();
  const ParameterTable& table = problem.table();
  const StepConfig& step = config.steps.front();
  IdentifyTask task;
  task.base = detail::search_base(step, problem);
  std::set<int> taken(task.base.begin(), task.base.end());
  const auto index = [&](const std::string& name) { return table.find(name); };
  const auto add_mount = [&](const std::string& joint, int rank) {
    IdentifyCandidate& mount = task.candidates.emplace_back();
    mount.name = "frame of " + joint;
    mount.rank = rank;
    mount.in_part = true;
    for (const auto axis : kFrameAxes)
      mount.parameters.push_back(index(parameter_name(joint, axis)));
  };
  for (const FreeFrameConfig& frame : step.free_frames) {  // how a head or an arm is mounted
    const bool whole =
        std::all_of(frame.axes.begin(), frame.axes.end(), [](bool axis) { return axis; });
    if (!detail::is_base_frame(robot, frame) && whole) add_mount(frame.name, detail::kMount);
  }
  for (const detail::HeldMount& mount : detail::held_mounts(config, robot))
    add_mount(mount.joint, mount.rank);
  const auto add = [&](int rank, const std::string& name, const std::vector<std::string>& parts) {
    IdentifyCandidate candidate{name, {}, rank};
    for (const std::string& part : parts) {
      const int p = index(part);
      if (p < 0 || !taken.insert(p).second) return;
      candidate.parameters.push_back(p);
    }
    task.candidates.push_back(std::move(candidate));
  };
  const std::vector<const Joint*> joints =
      detail::moving_joints(detail::model_chains(config, robot), robot);
  for (const Joint* joint : joints) add(detail::kZero, joint->name, {joint->name});
  for (const ModelConfig& model : step.models) {
    for (const std::string& name : detail::sensor_parameters(step, model)) {
      add(detail::kOfSensor, name, {name});
    }
  }
  for (const Joint* joint : joints) {
    for (const auto axis : kFrameAxes) {
      const std::string name = parameter_name(joint->name, axis);
      add(detail::kGeometry, name, {name});
    }
  }
  if (geometry_only) return task;
  for (const detail::ModelCandidate& of_joint : detail::model_candidates(config, robot, samples)) {
    std::string name;
    for (const std::string& part : of_joint.parameters) name += (name.empty() ? "" : ", ") + part;
    add(of_joint.rank, name, of_joint.parameters);
  }
  return task;
}

std::string candidate_name(const IdentifyCandidate& candidate, const ParameterTable& table) {
  const std::vector<int>& own = candidate.parameters;
  if (!candidate.in_part || own.size() == kFrameAxes.size()) return candidate.name;
  std::string axes;
  for (const int p : own) axes += " " + table[p].name.substr(table[p].name.rfind('_') + 1);
  return candidate.name + ":" + axes;
}

Config identified_config(const Config& config, const IdentifyTask& task, const Identified& found,
                         const AnyProblem& problem) {
  Config all = config;
  StepConfig& step = all.steps.front();
  const std::vector<FreeParamConfig> before = step.free_params;
  step.free_params.clear();
  std::erase_if(step.free_frames, [&](const FreeFrameConfig& frame) {
    return !frame.is_fixed && !detail::is_base_frame(problem.robot(), frame);
  });
  for (const FreeParamConfig& parameter : before) {
    const int p = problem.table().find(parameter.name);
    if (std::find(task.base.begin(), task.base.end(), p) != task.base.end())
      step.free_params.push_back(parameter);
  }
  for (const auto& [k, turn] : found.turned) {
    const Parameter& p =
        problem.table()[task.candidates[static_cast<std::size_t>(k)].parameters.front()];
    std::erase_if(step.initial_values,
                  [&](const InitialValueConfig& value) { return value.name == p.name; });
    step.initial_values.push_back({p.name, p.initial + turn, step.place});
  }
  for (const int k : found.chosen) {
    for (const int p : task.candidates[static_cast<std::size_t>(k)].parameters) {
      const std::string& name = problem.table()[p].name;
      const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
      std::size_t axis = 0;
      while (axis < 6 && name != parameter_name(owner, kFrameAxes[axis])) ++axis;
      if (axis < 6 && problem.frames().contains(owner)) {
        detail::free_axis(step, owner, axis);
      } else {
        step.free_params.push_back({name, step.place});
      }
    }
  }
  for (const FreeFrameConfig& frame :
       step.free_frames) {  // poses that were searched for are known now
    const bool is_whole =
        std::all_of(frame.axes.begin(), frame.axes.end(), [](bool a) { return a; });
    if (frame.is_fixed || found.result.table.size() == 0) continue;
    if (problem.robot().has_joint(frame.name)) {
      const std::vector<FreeFrameConfig>& given = config.steps.front().free_frames;
      const bool was_free = std::any_of(given.begin(), given.end(),
                                        [&](const auto& of) { return of.name == frame.name; });
      const bool begins_at_urdf =
          !was_free && detail::has_origin(problem.robot().joint(frame.name));
      if (!is_whole || begins_at_urdf) continue;
    }
    Eigen::Matrix<double, 6, 1> pose;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      pose(static_cast<Eigen::Index>(axis)) =
          found.result.table[parameter_name(frame.name, kFrameAxes[axis])].value;
    }
    std::erase_if(step.frame_initial_values,
                  [&](const auto& initial) { return initial.name == frame.name; });
    step.frame_initial_values.push_back({frame.name, pose.head<3>(),
                                         rpy_from_rotation(exp(Vector3<double>(pose.tail<3>()))),
                                         frame.place});
  }
  std::erase_if(step.bounds,
                [&](const BoundConfig& bound) { return !detail::is_free(step, bound.name); });
  return all;
}

}  // namespace kinecal
