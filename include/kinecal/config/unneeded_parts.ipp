// What a configuration names and this calibration does not need: priors on what no step frees,
// initial values of frames that are not free, models that no error block compares.
//
// robot_calibration runs such files, so each is a warning and has no effect.  A name that neither
// the robot nor the samples have stays an error: it is probably misspelt.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/missing_sensors.ipp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/errors/prior.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/parameters/joint_models.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal::detail {

/// Names of the robot and of the frames in which features were recorded.
struct KnownNames {
  const Robot& robot;
  std::set<std::string> recorded;  ///< frames; empty without samples
  bool have_samples = false;

  [[nodiscard]] bool has_frame(const std::string& name) const {
    return robot.has_joint(name) || robot.has_link(name) ||
           recorded.contains(std::string(plain_frame(name)));
  }
  /// True for a joint, link or frame, or a parameter of one: elbow_gear_ratio, tool_joint_x.
  [[nodiscard]] bool has(const std::string& name) const {
    const auto is_part = [&](std::string_view part) {
      const std::string suffix = "_" + std::string(part);
      return name.ends_with(suffix) && has_frame(name.substr(0, name.size() - suffix.size()));
    };
    return has_frame(name) || std::any_of(kFrameAxes.begin(), kFrameAxes.end(), is_part) ||
           joint_model_parameter(robot, name).has_value();
  }
  /// True if nothing shows that a name is misspelt: it is known, or, without samples, it may be a
  /// frame of features and resembles no other name.
  /// @param others  names that could be meant
  template <class Names>
  [[nodiscard]] bool may_be_meant(const std::string& name, const Names& others) const {
    return has(name) || (!have_samples && !nearest_name(name, others) &&
                         !nearest_name(name, robot.joint_names()));
  }
};

/// Drops priors on what no step frees.
inline void drop_priors_without_effect(Config& config, const ParameterTable& table,
                                       const KnownNames& known, Diagnostics& diagnostics) {
  std::set<int> free;
  for (const StepConfig& step : config.steps) {
    for (const FreeParamConfig& param : free_parameters(step)) free.insert(table.find(param.name));
  }
  free.erase(-1);
  std::vector<std::string> names;
  for (const Parameter& parameter : table) names.push_back(parameter.name);
  for (StepConfig& step : config.steps) {
    std::erase_if(step.error_blocks, [&](const BlockConfig& block) {
      if (block.param.empty()) return false;
      const auto rows = Prior{block.param}.parameters(table);
      const bool exists = std::any_of(rows.begin(), rows.end(), [](int p) { return p >= 0; });
      const bool is_held =
          std::none_of(rows.begin(), rows.end(), [&](int p) { return free.contains(p); });
      if (!is_held || (!exists && !known.may_be_meant(block.param, names))) return false;
      diagnostics.warning(block.place, fmt::format("error block '{}' has no effect: no step frees "
                                                   "its param '{}'",
                                                   block.name, block.param));
      return !exists;
    });
  }
}

/// Reports initial values of frames that are free neither in their step nor before it.
inline void check_initial_frames(const Config& config, const KnownNames& known,
                                 Diagnostics& diagnostics) {
  std::set<std::string> free;
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& frame : step.free_frames) free.insert(frame.name);
    for (const FrameInitialValueConfig& value : step.frame_initial_values) {
      if (free.contains(value.name)) continue;
      const std::string subject = "initial value of free frame '" + value.name + "'";
      if (known.has(value.name) || !nearest_name(value.name, free)) {
        diagnostics.warning(value.place,
                            subject + " has no effect: the frame is not free in this step");
      } else {
        diagnostics.error(value.place, subject + ": there is no such free frame" +
                                           did_you_mean(value.name, free));
      }
    }
  }
}

/// Drops models that no error block compares and that do not fit the robot.
inline void drop_models_without_use(Config& config, const Robot& robot, Diagnostics& diagnostics) {
  for (StepConfig& step : config.steps) {
    if (step.error_blocks.empty()) continue;  // they are wrong, so what they use is not known
    std::erase_if(step.models, [&](const ModelConfig& model) {
      if (is_used(step, model.name)) return false;
      try {
        (void)make_chain(robot, config.base_link, model.frame);
        return false;
      } catch (const RobotError& e) {
        diagnostics.warning(model.place,
                            fmt::format("model '{}': {}; no error block uses the model,"
                                        " so it is left out",
                                        model.name, e.what()));
        return true;
      }
    });
  }
}

/// The configuration without what has no effect; each is a warning.
[[nodiscard]] inline Config without_unneeded(Config config, const Robot& robot,
                                             const ParameterTable& table,
                                             std::span<const Sample> samples,
                                             Diagnostics& diagnostics) {
  const KnownNames known{robot, feature_frames(samples), !samples.empty()};
  drop_priors_without_effect(config, table, known, diagnostics);
  check_initial_frames(config, known, diagnostics);
  drop_models_without_use(config, robot, diagnostics);
  return config;
}

}  // namespace kinecal::detail
