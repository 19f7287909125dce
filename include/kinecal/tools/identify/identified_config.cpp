// Definitions of identified_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/identified_config.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/problem/sample_reading.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/identify/candidates.ipp"

namespace kinecal {

namespace detail {
namespace {

// The joint models that a robot's joints may have, as candidates.

/// Parameters that come in together.
struct ModelCandidate {
  int rank = 0;  ///< see IdentifyRank
  std::vector<std::string> parameters;
};

/// A model of a joint, and whether samples say what it needs.
struct ModelProbe {
  int rank = 0;
  const AnyJointModel* model = nullptr;
  const Joint* joint = nullptr;
  std::optional<double> effect = {};  ///< that of its first parameter in some sample
  int others = 0;                     ///< samples in which that is another
  bool is_unknown = false;            ///< a sample does not say it

  /// True if the samples say it, and it differs: backlash needs a joint that came from both sides.
  [[nodiscard]] bool is_candidate() const {
    constexpr int kFewest = 5;
    return !is_unknown && others >= kFewest;
  }
};

/// Asks each model, without a partner, for its effect in each sample.
void ask_models(const Robot& robot, std::span<const Sample> samples,
                std::vector<ModelProbe>& probes) {
  for (const Sample& sample : samples) {
    SampleLoads loads(robot, sample);
    for (ModelProbe& probe : probes) {
      if (probe.is_unknown) continue;
      try {
        const SampleReading reading(sample, probe.joint->name, loads, false);
        const double effect = probe.model->effect(0, reading, {});
        if (effect == 0.0) continue;
        if (!probe.effect) probe.effect = effect;
        probe.others += effect != *probe.effect ? 1 : 0;
      } catch (const SampleError&) {  // that joints are missing is reported elsewhere
        probe.is_unknown = true;
      }
    }
  }
}

/// True if all samples have the velocities of joints, and some moved.
[[nodiscard]] bool have_velocities(const std::vector<const Joint*>& joints,
                                   std::span<const Sample> samples) {
  constexpr double kMoves = 1e-2;  // rad/s or m/s
  bool moved = false;
  for (const Sample& sample : samples) {
    for (const Joint* joint : joints) {
      const std::optional<double> velocity = sample.velocity(joint->name);
      if (!velocity || !std::isfinite(*velocity)) return false;
      moved |= std::abs(*velocity) > kMoves;
    }
  }
  return moved;
}

/// The joints that move right before and after a joint in a chain.
[[nodiscard]] std::set<std::string> neighbours_of(const std::string& joint,
                                                  const std::vector<ModelChain>& chains) {
  std::set<std::string> neighbours;
  for (const ModelChain& of : chains) {
    std::string before;  // the joint that moves before
    for (const ChainJoint& one : of.chain.joints) {
      if (!has_position(one)) continue;
      if (one.drive.joint == joint) neighbours.insert(before);
      if (before == joint) neighbours.insert(one.drive.joint);
      before = one.drive.joint;
    }
  }
  neighbours.erase(joint);
  neighbours.erase("");
  return neighbours;
}

/// Links beyond a joint whose masses could pull at it, at least 0.15 m apart, and the last ones.
[[nodiscard]] std::set<std::string> links_beyond(const Robot& robot, const std::string& joint,
                                                 const std::vector<ModelChain>& chains) {
  constexpr double kApart = 0.15;  // metres
  std::set<std::string> links;
  for (const ModelChain& of : chains) {
    bool beyond = false;
    double way = 0.0;
    for (const ChainJoint& one : of.chain.joints) {
      if (beyond) way += one.fixed.translation.norm();
      if (beyond && way > kApart && has_position(one)) {
        links.insert(robot.joint(one.name).child);
        way = 0.0;
      }
      beyond |= one.drive.joint == joint && !one.reversed;
    }
    if (beyond && way + of.chain.tail.translation.norm() > 0.0) links.insert(of.chain.tip);
  }
  return links;
}

/// Joint models of the joints that move a sensor, and lags of the sensors.  Couplings are of neighbours;
/// where the URDF has no masses, sag is by the mass of a link.
[[nodiscard]] std::vector<ModelCandidate> model_candidates(const Config& config, const Robot& robot,
                                                           std::span<const Sample> samples) {
  std::vector<ModelCandidate> all;
  const std::vector<ModelChain> chains = model_chains(config, robot);
  const std::vector<const Joint*> moving = moving_joints(chains, robot);
  const bool has_masses = !robot.weight().links.empty();
  std::set<const Joint*> mimics;
  for (const ModelChain& of : chains) {
    for (const ChainJoint& joint : of.chain.joints) {
      if (has_position(joint) && joint.drive.joint != joint.name)
        mimics.insert(&robot.joint(joint.name));
    }
  }
  std::vector<const Joint*> joints = moving;
  joints.insert(joints.end(), mimics.begin(), mimics.end());
  const auto add = [&](int rank, const AnyJointModel& model, const Joint& joint,
                       const std::string& partner) {
    ModelCandidate& candidate = all.emplace_back(ModelCandidate{rank, {}});
    for (const ParameterInfo& info : model.parameters()) {
      const std::string name = parameter_name(joint.name, info.name);
      candidate.parameters.push_back(partner.empty() ? name : name + "_" + partner);
    }
  };
  std::vector<ModelProbe> probes;
  for (const Joint* joint : joints) {
    int rank = kJointModel;
    for (const auto& model : joint_models()) {
      const int own = rank++;
      if (!model->suits(joint->type, joint->mimic.has_value())) continue;
      if (model->needs_masses() && !has_masses) continue;
      if (model->partner() == ModelPartner::none) probes.push_back({own, model.get(), joint});
      if (model->partner() == ModelPartner::link && !has_masses) {
        for (const std::string& link : links_beyond(robot, joint->name, chains))
          add(own, *model, *joint, link);
      }
      if (model->partner() == ModelPartner::joint && !joint->mimic) {
        for (const std::string& other : neighbours_of(joint->name, chains))
          add(own, *model, *joint, other);
      }
    }
  }
  ask_models(robot, samples, probes);
  for (const ModelProbe& probe : probes) {
    if (probe.is_candidate()) add(probe.rank, *probe.model, *probe.joint, "");
  }
  if (!have_velocities(moving, samples)) return all;
  for (const ModelChain& of : chains) {
    const auto moves_it = [](const ChainJoint& joint) { return moves(joint.type); };
    if (std::any_of(of.chain.joints.begin(), of.chain.joints.end(), moves_it))
      all.push_back({kLagOfSensor, {lag_name(*of.model)}});
  }
  return all;
}

}  // namespace
}  // namespace detail

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
