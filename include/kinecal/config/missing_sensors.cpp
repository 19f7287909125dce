// Definitions of missing_sensors.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/missing_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kinecal::detail {

std::string quoted_list(const std::vector<std::string>& names, std::size_t most,
                        const std::string& noun) {
  std::string text;
  const std::size_t shown = names.size() > most + 1 ? most : names.size();
  for (std::size_t i = 0; i < shown; ++i) {
    const bool is_last = i + 1 == names.size();
    text += fmt::format("{}'{}'", i == 0 ? "" : is_last ? " and " : ", ", names[i]);
  }
  if (shown == names.size()) return text;
  return text + " and " + counted(names.size() - shown, "more " + noun);
}

bool MissingSensors::has(const std::string& model) const {
  return std::any_of(models.begin(), models.end(),
                     [&](const ModelConfig* one) { return one->name == model; });
}

bool MissingSensors::are_in(const BlockConfig& block) const {
  return std::any_of(block.models.begin(), block.models.end(),
                     [&](const std::string& model) { return has(model); });
}

bool is_used(const StepConfig& step, const std::string& model) {
  return std::any_of(step.error_blocks.begin(), step.error_blocks.end(), [&](const auto& block) {
    return std::find(block.models.begin(), block.models.end(), model) != block.models.end();
  });
}

MissingSensors missing_sensors(const StepConfig& step, std::span<const Sample> samples) {
  MissingSensors missing;
  if (samples.empty()) return missing;
  std::set<std::string> recorded;
  for (const Sample& sample : samples) {
    for (const Observation& observation : sample.observations) recorded.insert(observation.sensor);
  }
  std::set<std::string> others = recorded;
  for (const ModelConfig& model : step.models) {
    others.erase(model.name);
    if (!recorded.contains(model.name) && is_used(step, model.name)) {
      missing.models.push_back(&model);
    }
  }
  missing.others.assign(others.begin(), others.end());
  return missing;
}

std::string sentence_of(const MissingSensors& missing) {
  std::vector<std::string> names;
  for (const ModelConfig* model : missing.models) {
    if (!model->is_surface) names.push_back(model->name);
  }
  if (names.empty()) {
    return "what the camera observes is not associated with the surface of the robot; 'kinecal "
           "calibrate', 'check', 'identify', 'verify' and 'evaluate' do that, with the meshes of "
           "the URDF";
  }
  std::string text = fmt::format(
      "{} {}: no sample has {}", names.size() == 1 ? "model" : "models", quoted_list(names),
      names.size() == 1 ? "a sensor of that name" : "sensors of these names");
  if (missing.others.empty()) return text;
  const bool camera = sensor_entry(*missing.models.front()).sensor->is_camera();
  const std::string key = camera ? "camera_sensor_name" : "chain_sensor_name";
  std::optional<std::string> meant;
  if (names.size() == 1) meant = nearest_name(names.front(), missing.others);
  if (names.size() == 1 && missing.others.size() == 1) meant = missing.others.front();
  if (meant) {
    return text + fmt::format(
                      "; did you mean '{0}'?  Name the model '{0}', or the sensor '{1}' ({2} "
                      "in capture.yaml)",
                      *meant, names.front(), key);
  }
  return text + fmt::format("; the samples have {}; rename {} or the sensors",
                            quoted_list(missing.others),
                            names.size() == 1 ? "the model" : "the models");
}

Consequences::Consequences(const MissingSensors& missing, const StepConfig& step,
                           const AnyProblem& problem) {
  for (const ModelConfig* model : missing.models) {
    owners_.insert(mount_from(*model).parameter_prefix());
    const RuntimeChain chain =
        make_chain(problem.robot(), problem.base(), model->frame, problem.frames());
    for (const ChainJoint& joint : chain.joints) {
      owners_.insert(joint.name);
      owners_.insert(joint.drive.joint);
    }
  }
  if (missing.models.empty()) return;
  for (const BlockConfig& block : step.error_blocks) {
    if (missing.are_in(block)) owners_.insert(block.name);
  }
  for (const std::string& frame : problem.frames()) {
    if (!problem.robot().has_joint(frame)) owners_.insert(frame);  // of a target
  }
}

bool Consequences::contain(const std::string& parameter) const {
  return std::any_of(owners_.begin(), owners_.end(), [&](const std::string& owner) {
    return parameter == owner || parameter.starts_with(owner + "_");
  });
}

}  // namespace kinecal::detail
