// Definitions of configured_sensor.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/configured_sensor.hpp"

#include <algorithm>

#include "kinecal/parameters/joint_models/joint_models.hpp"

namespace kinecal::detail {

const SensorEntry& sensor_entry(const ModelConfig& model) {
  const SensorEntry* entry = entry_of(model);
  if (entry != nullptr) return *entry;
  const std::vector<SensorEntry>& all =
      registry().sensors();  // any camera: for names of parameters
  return *std::find_if(all.begin(), all.end(),
                       [](const SensorEntry& one) { return measures_depth(*one.sensor); });
}

std::shared_ptr<const AnySensor> sensor_of(const ModelConfig& model) {
  return sensor_entry(model).make(options_of(model));
}

std::string free_coefficient(const Config& config, const ModelConfig& camera) {
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  const std::span<const ParameterInfo> all = sensor->parameters();
  for (const StepConfig& step : config.steps) {
    for (const FreeParamConfig& free : step.free_params) {
      for (std::size_t i = kIntrinsics; i < all.size(); ++i) {
        if (free.name == parameter_name(camera.param_name, all[i].name)) return free.name;
      }
    }
  }
  return {};
}

SensorOptions options_of(const ModelConfig& model) {
  return {model.image, model.lens == kAnyLens ? "" : model.lens};
}

Mount mount_from(const ModelConfig& model) {
  return {model.name, model.frame, model.param_name, model.links};
}

std::string lag_name(const ModelConfig& model) {
  return parameter_name(mount_from(model).parameter_prefix(), kLag.name);
}

}  // namespace kinecal::detail
