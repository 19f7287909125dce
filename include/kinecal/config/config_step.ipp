// One step of a configuration, in either dialect.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config_blocks.ipp"
#include "kinecal/config/config_free.ipp"
#include "kinecal/config/config_models.ipp"

namespace kinecal::detail {

/// The configuration so far, and information for later steps.
struct ConfigProgress {
  Config config;
  FreeAxes free_axes;  ///< free in one of the steps so far
  NothingFree nothing_free = NothingFree::is_error;
};

/// Reads the settings of the file or of a step; returns max_num_iterations, or the fallback.
inline int read_settings(ConfigMap& map, int fallback, ConfigProgress& progress) {
  map.ignore({"verbose"});
  if (const auto link = map.text("base_link")) {
    const SourceLocation place = map.find("base_link")->place;
    if (!progress.config.base_link_place) {
      progress.config.base_link = *link;
      progress.config.base_link_place = place;
    } else if (*link != progress.config.base_link) {
      map.error(place, "base_link '" + *link + "' differs from '" + progress.config.base_link +
                           "' in line " + std::to_string(progress.config.base_link_place->line) +
                           "; all steps must have the same base_link");
    }
  }
  if (std::optional<ConfigMap> gravity = map.map("gravity", "gravity")) {
    const auto along = [&](const char* axis) { return gravity->number(axis, 0.0); };
    progress.config.gravity = {along("x"), along("y"), along("z")};
    gravity->report_unknown();
  }
  if (const auto link = map.text("payload_link")) progress.config.payload_link = *link;
  std::vector<FreeParamConfig>& frames = progress.config.per_sample;
  for (const ConfigEntry& entry : map.list("per_sample")) {
    if (const auto name = config_text(entry.value)) {
      if (std::ranges::find(frames, *name, &FreeParamConfig::name) == frames.end()) {
        frames.push_back({*name, entry.place});
      }
    } else {
      map.error(entry.place,
                "per_sample: " + describe_config(entry.value) + " is not the name of a frame");
    }
  }
  return map.count("max_num_iterations", fallback);
}

/// Reports models of a type that does not exist; one that no error block uses is left out.
inline void check_model_types(std::vector<ConfigItem>& items, StepConfig& step) {
  for (ConfigItem& item : items) {
    const auto type = item.map ? item.map->text("type") : std::nullopt;
    const auto model = std::find_if(step.models.begin(), step.models.end(),
                                    [&](const ModelConfig& m) { return m.name == item.name; });
    if (!type || model == step.models.end() || !model->type.empty()) continue;
    if (nearest_name(*type, model_types())) continue;  // read_model() has reported it
    const auto uses = [&](const BlockConfig& block) {
      return std::find(block.models.begin(), block.models.end(), item.name) != block.models.end();
    };
    const std::string what = "type '" + *type + "' is not a model";
    if (std::any_of(step.error_blocks.begin(), step.error_blocks.end(), uses)) {
      item.map->error(item.map->find("type")->place, what);
    } else {
      item.map->warning(item.map->find("type")->place,
                        what + "; no error block uses it, so it is left out");
      step.models.erase(model);
    }
  }
}

inline void check_step(ConfigMap& map, StepConfig& step, NothingFree nothing_free) {
  require_items(map, kModelItems);
  require_items(map, kErrorBlockItems);
  check_free_parameters(map, step);
  std::vector<std::string> free;
  for (const FreeParamConfig& parameter : free_parameters(step)) free.push_back(parameter.name);
  check_bounds(map, step.bounds, free, "in this step");
  const bool has_list = map.find("free_params") != nullptr || map.find("free_frames") != nullptr;
  const bool may_be_empty = nothing_free == NothingFree::is_allowed ||
                            (nothing_free == NothingFree::without_lists && !has_list);
  if (free.empty() && !may_be_empty) {
    map.error(map.place(),
              "nothing is free; name parameters under 'free_params' or frames under "
              "'free_frames', or let 'kinecal identify' find them");
  }
}

/// Reads a step and adds it to the configuration.
/// @param map   the step's keys
/// @param find  how the dialect finds the items of a list
inline void read_step(ConfigMap& map, const FindConfigItems& find, const std::string& name,
                      int max_num_iterations, ConfigProgress& progress) {
  StepConfig step;
  step.name = name;
  step.place = map.place();
  step.max_num_iterations = read_settings(map, max_num_iterations, progress);
  std::vector<ConfigItem> models = find(map, kModelItems);
  for (ConfigItem& item : models) step.models.push_back(read_model(item));
  read_free_params(map, step);
  for (ConfigItem& item : find(map, kFreeFrameItems)) {
    step.free_frames.push_back(read_free_frame(item));
    const FreeFrameConfig& frame = step.free_frames.back();
    auto& axes = progress.free_axes[frame.name];
    for (std::size_t i = 0; i < 6; ++i) axes[i] = axes[i] || frame.axes[i];
  }
  std::vector<InitialValueConfig> fixed;
  for (ConfigItem& item : find(map, kFixedFrameItems)) {
    for (const InitialValueConfig& value : read_fixed_frame(item, step)) fixed.push_back(value);
  }
  for (ConfigItem& item : find(map, kInitialValueItems)) {
    step.frame_initial_values.push_back(read_frame_initial_value(item, progress.free_axes));
  }
  for (ConfigItem& item : find(map, kErrorBlockItems)) {
    step.error_blocks.push_back(read_block(item, step.models));
  }
  check_model_types(models, step);
  step.initial_values = read_initial_values(map);
  step.initial_values.insert(step.initial_values.end(), fixed.begin(), fixed.end());
  step.bounds = read_bounds(map);
  check_step(map, step, progress.nothing_free);
  map.report_unknown();
  progress.config.steps.push_back(std::move(step));
}

/// initial_values and bounds of a file with several steps.  Values are set before the first step.
/// Bounds apply in every step that frees the parameter and has no bounds of its own for it.
inline void share_values(ConfigMap& map, ConfigProgress& progress) {
  std::vector<StepConfig>& steps = progress.config.steps;
  const std::vector<InitialValueConfig> values = read_initial_values(map);
  std::vector<BoundConfig> bounds = read_bounds(map);
  if (steps.empty()) return;
  const auto add = [](auto& own, const auto& shared) {
    const auto has_name = [&](const auto& item) { return item.name == shared.name; };
    if (std::none_of(own.begin(), own.end(), has_name)) own.push_back(shared);
  };
  for (const InitialValueConfig& value : values) add(steps.front().initial_values, value);
  std::vector<std::string> all_free;
  for (StepConfig& step : steps) {
    for (const FreeParamConfig& parameter : free_parameters(step)) {
      all_free.push_back(parameter.name);
      for (const BoundConfig& bound : bounds) {
        if (bound.name == parameter.name) add(step.bounds, bound);
      }
    }
  }
  check_bounds(map, bounds, all_free, "in any step");
}

}  // namespace kinecal::detail
