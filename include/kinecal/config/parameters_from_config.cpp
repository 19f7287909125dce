// Definitions of parameters_from_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/parameters_from_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/parameters/joint_parameters.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal::detail {

std::vector<ParameterInfo> own_parameters(const BlockConfig& block) {
  const BlockEntry* entry = entry_of(block);
  if (entry == nullptr) return {};
  try {
    return entry->parameters(block);
  } catch (const std::exception&) {  // reported where the block is read
    return {};
  }
}

std::set<std::string> feature_frames(std::span<const Sample> samples) {
  std::set<std::string> frames;
  for (const Sample& sample : samples) {
    for (const Observation& observation : sample.observations) {
      for (const Feature& feature : observation.features) {
        frames.insert(std::string(plain_frame(feature.frame)));
      }
    }
  }
  return frames;
}

/// Adds the offset of a joint, or reports why it cannot have one: a fixed joint has none, which
/// changes nothing, but the offset of a mimic joint would be lost.
inline void add_joint(ParameterTable& table, const Robot& robot, const std::string& name,
                      const SourceLocation& place, Diagnostics& diagnostics) {
  const Joint& joint = robot.joint(name);
  if (!moves(joint.type)) {
    diagnostics.warning(place, fmt::format("joint '{}' is {} and has no offset, so it is left out; "
                                           "free_frames frees its frame",
                                           name, to_string(joint.type)));
    return;
  }
  if (joint.mimic) {
    diagnostics.error(place, fmt::format("joint '{}' mimics '{}'; free the offset of '{}' instead",
                                         name, joint.mimic->joint, drive(robot, joint).joint));
    return;
  }
  add_joint_offset(table, name, joint.type);
}

/// Adds a parameter of a joint model, "elbow_gear_ratio", or reports why the joint cannot have it.
/// @returns  false if the name is not one of a joint and a joint model
inline bool add_joint_model(ParameterTable& table, const Robot& robot, const std::string& name,
                            const SourceLocation& place, Diagnostics& diagnostics) {
  const std::optional<JointModelParameter> of = joint_model_parameter(robot, name);
  if (!of) return false;
  if (of->fault.empty()) {
    table.add({.name = name, .unit = of->unit});
  } else {
    diagnostics.error(place, fmt::format("'{}': joint '{}' {}", name, of->joint, of->fault));
  }
  return true;
}

/// Reports a fixed frame that is in the URDF, and warns of one without features.
inline void check_fixed_frame(const FreeFrameConfig& frame, const Robot& robot,
                              const std::set<std::string>& recorded, bool have_samples,
                              Diagnostics& diagnostics) {
  if (robot.has_joint(frame.name) || robot.has_link(frame.name)) {
    diagnostics.error(frame.place,
                      fmt::format("fixed frame '{}' is a {} of the robot, whose URDF says where it "
                                  "is; fixed_frames are beyond the link of a model",
                                  frame.name, robot.has_joint(frame.name) ? "joint" : "link"));
  } else if (have_samples && !recorded.contains(std::string(plain_frame(frame.name)))) {
    diagnostics.warning(frame.place,
                        fmt::format("fixed frame '{}': no feature of the samples is in it{}",
                                    frame.name, did_you_mean(frame.name, recorded)));
  }
}

/// Reports a free frame that is neither a joint nor a virtual frame of recorded features.
/// Warns of a joint's frame with two of three rotations free.  Of what a sample is compared with, such as a plane, the third
/// may have no effect.
inline void check_two_rotations(const FreeFrameConfig& frame, Diagnostics& diagnostics) {
  if (std::count(frame.axes.begin() + 3, frame.axes.end(), true) != 2) return;
  constexpr std::array<const char*, 3> kRotations = {"roll", "pitch", "yaw"};
  std::string free, held;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name = kRotations[i];
    (frame.axes[3 + i] ? free : held) += (frame.axes[3 + i] && !free.empty() ? " and " : "") + name;
  }
  diagnostics.warning(
      frame.place,
      fmt::format(
          "free frame '{}': {} are free and {} is not: the free parameters are two components "
          "of a rotation vector, not {} themselves, and large values change {} as well; free "
          "one rotation or all three",
          frame.name, free, held, free, held));
}

inline void check_frame(const FreeFrameConfig& frame, const Robot& robot,
                        const std::set<std::string>& recorded, bool have_samples,
                        Diagnostics& diagnostics) {
  if (frame.is_fixed) return check_fixed_frame(frame, robot, recorded, have_samples, diagnostics);
  if (robot.has_joint(frame.name)) {
    if (robot.joint(frame.name).type != JointType::floating) {
      return check_two_rotations(frame, diagnostics);
    }
    const std::string wrong = "' is a floating joint, whose pose is measured; free a fixed joint";
    diagnostics.error(frame.place, "free frame '" + frame.name + wrong + " before or after it");
    return;
  }
  if (robot.has_link(frame.name)) {
    const Joint* joint = robot.parent_joint(frame.name);
    diagnostics.error(frame.place,
                      fmt::format("free frame '{}' is a link; frames are named by their joint{}",
                                  frame.name, joint ? ": '" + joint->name + "'" : ""));
    return;
  }
  if (recorded.contains(std::string(plain_frame(frame.name)))) return;
  const auto nearest = nearest_name(frame.name, robot.joint_names());
  if (nearest) {
    diagnostics.error(frame.place,
                      fmt::format("free frame '{}' is neither a joint of the robot nor "
                                  "a frame of the samples; did you mean '{}'?",
                                  frame.name, *nearest));
  } else if (have_samples) {
    diagnostics.warning(frame.place,
                        fmt::format("free frame '{}' is neither a joint of the robot nor "
                                    "a frame of the samples; it keeps its initial value",
                                    frame.name));
  }
}

/// Names that free_params of a step may contain.
[[nodiscard]] inline std::vector<std::string> free_param_names(const Robot& robot,
                                                               const StepConfig& step) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints()) {
    if (moves(joint.type) && !joint.mimic) names.push_back(joint.name);
    for (std::string& name : joint_model_names(robot, joint)) names.push_back(std::move(name));
  }
  for (const ModelConfig& model : step.models) {
    const std::shared_ptr<const AnySensor> sensor = sensor_of(model);
    for (const ParameterInfo& info : sensor->parameters()) {
      names.push_back(parameter_name(mount_from(model).parameter_prefix(), info.name));
    }
    names.push_back(lag_name(model));
  }
  for (const BlockConfig& block : step.error_blocks) {
    for (const ParameterInfo& info : own_parameters(block)) {
      names.push_back(parameter_name(block.name, info.name));
    }
  }
  return names;
}

/// Adds the lag of a sensor.
/// @returns  false if the name is not one
inline bool add_lag(ParameterTable& table, const StepConfig& step, const std::string& name) {
  const bool is_lag =
      std::any_of(step.models.begin(), step.models.end(),
                  [&](const ModelConfig& model) { return name == lag_name(model); });
  if (is_lag) table.add({.name = name, .unit = std::string(kLag.unit)});
  return is_lag;
}

inline void add_params(ParameterTable& table, const Robot& robot, const StepConfig& step,
                       Diagnostics& diagnostics) {
  for (const FreeParamConfig& param : step.free_params) {
    if (table.find(param.name) >= 0) continue;  // of a sensor or block
    if (add_lag(table, step, param.name)) continue;
    if (robot.has_joint(param.name)) {
      add_joint(table, robot, param.name, param.place, diagnostics);
      continue;
    }
    if (add_joint_model(table, robot, param.name, param.place, diagnostics)) {
      if (table.find(param.name) < 0) continue;
      if (fits_urdf(checked_joint_model(robot, param.name))) continue;
      diagnostics.warning(param.place,
                          fmt::format("a URDF cannot hold '{}'; apply it in the driver of the "
                                      "joint: calibration.yaml has its value",
                                      param.name));
      continue;
    }
    diagnostics.error(
        param.place,
        fmt::format("free parameter '{}' is neither a joint of the robot nor a parameter of a "
                    "joint, sensor or error block{}",
                    param.name, did_you_mean(param.name, free_param_names(robot, step))));
  }
}

inline void add_valued_joints(ParameterTable& table, const Robot& robot, const StepConfig& step,
                              Diagnostics& diagnostics) {
  const auto check = [&](const std::string& name, const SourceLocation& place, const char* what) {
    if (table.find(name) >= 0) return;
    if (robot.has_joint(name)) {
      add_joint(table, robot, name, place, diagnostics);
      return;
    }
    if (add_lag(table, step, name) || add_joint_model(table, robot, name, place, diagnostics))
      return;
    std::vector<std::string> names = free_param_names(robot, step);
    for (const Parameter& parameter : table) names.push_back(parameter.name);
    diagnostics.error(place, fmt::format("{} '{}' is not a parameter of this calibration{}", what,
                                         name, did_you_mean(name, names)));
  };
  for (const auto& value : step.initial_values) check(value.name, value.place, "initial value:");
  for (const auto& bound : step.bounds) check(bound.name, bound.place, "bound:");
}

/// Reports a parameter of a frame, sensor or block with the name of a joint, which would be
/// ambiguous.
inline void check_collisions(const ParameterTable& table, const Robot& robot, const Config& config,
                             Diagnostics& diagnostics) {
  const auto check = [&](const std::string& name, const SourceLocation& place,
                         const std::string& owner) {
    if (table.find(name) < 0 || !robot.has_joint(name) || !moves(robot.joint(name).type)) return;
    diagnostics.error(place, fmt::format("parameter '{}' of {} has the name of a joint of the "
                                         "robot; rename one of them",
                                         name, owner));
  };
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& frame : step.free_frames) {
      for (auto axis : kFrameAxes) {
        check(parameter_name(frame.name, axis), frame.place, "frame '" + frame.name + "'");
      }
    }
    for (const ModelConfig& model : step.models) {
      const std::shared_ptr<const AnySensor> sensor = sensor_of(model);
      for (const ParameterInfo& info : sensor->parameters()) {
        check(parameter_name(mount_from(model).parameter_prefix(), info.name), model.place,
              "model '" + model.name + "'");
      }
    }
    for (const BlockConfig& block : step.error_blocks) {
      for (const ParameterInfo& info : own_parameters(block)) {
        check(parameter_name(block.name, info.name), block.place,
              "error block '" + block.name + "'");
      }
    }
  }
}

std::set<std::string> frames_of(const Config& config) {
  std::set<std::string> frames;
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& frame : step.free_frames) frames.insert(frame.name);
  }
  for (const FreeParamConfig& frame : config.per_sample) frames.insert(frame.name);
  return frames;
}

ParameterTable parameters_from(const Config& config, const Robot& robot,
                               std::span<const Sample> samples, Diagnostics& diagnostics) {
  ParameterTable table;
  const std::set<std::string> recorded = feature_frames(samples);
  for (const StepConfig& step : config.steps) {
    for (const ModelConfig& model : step.models) {
      add_sensor_parameters(table, *sensor_of(model), mount_from(model), samples);
    }
    for (const BlockConfig& block : step.error_blocks) {
      add_parameters(table, block.name, own_parameters(block));
    }
    for (const FreeFrameConfig& frame : step.free_frames) {
      check_frame(frame, robot, recorded, !samples.empty(), diagnostics);
      add_parameters(table, frame.name, kFrameParameters);
    }
    add_params(table, robot, step, diagnostics);
    add_valued_joints(table, robot, step, diagnostics);
  }
  for (const FreeParamConfig& frame : config.per_sample) {
    add_parameters(table, frame.name, kFrameParameters);
  }
  check_collisions(table, robot, config, diagnostics);
  return table;
}

std::vector<std::pair<int, double>> initial_assignments(const StepConfig& step,
                                                        const ParameterTable& table) {
  std::vector<std::pair<int, double>> assignments;
  for (const FrameInitialValueConfig& value : step.frame_initial_values) {
    const auto frame = std::find_if(step.free_frames.begin(), step.free_frames.end(),
                                    [&](const auto& f) { return f.name == value.name; });
    if (frame == step.free_frames.end()) continue;
    Eigen::Matrix<double, 6, 1> all;
    all << value.xyz, log(rotation_from_rpy(value.rpy));
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!frame->axes[axis]) continue;  // robot_calibration ignores it; the reader has warned
      const int index = table.find(parameter_name(value.name, kFrameAxes[axis]));
      assignments.emplace_back(index, all(static_cast<Eigen::Index>(axis)));
    }
  }
  for (const InitialValueConfig& value : step.initial_values) {
    if (const int index = table.find(value.name); index >= 0) {
      assignments.emplace_back(index, value.value);
    }
  }
  return assignments;
}

}  // namespace kinecal::detail
