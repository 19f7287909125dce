// Reads the error blocks of a configuration; the registry has their types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/config_items.ipp"
#include "kinecal/config/registry.hpp"

namespace kinecal::detail {

/// Reports a model that does not deliver the quantity the block takes.
inline void check_model_kind(const ConfigMap& map, const BlockConfig& block, const std::string& key,
                             const ModelConfig& model, Quantity quantity) {
  const SensorEntry* entry = entry_of(model);
  if (entry == nullptr || entry->sensor->delivers(quantity)) return;
  std::string fitting;
  bool several = false;
  for (const SensorEntry& other : registry().sensors()) {
    if (!other.sensor->delivers(quantity)) continue;
    several = !fitting.empty();
    fitting += (several ? " or " : "") + other.type;
  }
  map.error(block.place, key + " '" + model.name + "' is a " + model.type + "; it must be a " +
                             fitting + (several ? ", which observe " : ", which observes ") +
                             std::string(to_string(quantity)));
}

/// Reads one model of a block, under any of its keys.
inline void read_block_model(ConfigMap& map, const BlockSensorEntry& of_block,
                             const std::vector<ModelConfig>& models, BlockConfig& block) {
  const ConfigEntry* entry = nullptr;
  for (const std::string& key : of_block.keys) {
    const ConfigEntry* candidate = map.find(key);
    if (candidate != nullptr && entry != nullptr) {
      map.error(candidate->place, "'" + entry->key + "' and '" + key + "' are the same model");
    } else if (candidate != nullptr) {
      entry = candidate;
    }
  }
  const std::string key = entry == nullptr ? of_block.keys.front() : entry->key;
  const auto name = map.required_text(key);
  block.models.push_back(name.value_or(""));
  if (!name) return;
  std::vector<std::string> names;
  for (const ModelConfig& model : models) {
    if (model.name == *name) {
      return check_model_kind(map, block, key, model, of_block.quantity);
    }
    names.push_back(model.name);
  }
  map.error(block.place, key + " '" + *name + "' is not a model" + map.did_you_mean(*name, names));
}

/// Reads the numbers of a block and reports impossible ones.
inline void read_block_numbers(ConfigMap& map, const BlockEntry& entry, BlockConfig& block) {
  for (const auto& [name, fallback] : entry.numbers) {
    block.numbers[name] = map.number(name, fallback);
    // It weights all residuals; the weight of a part of them (normal_scale) may be zero.
    if (name == "scale" && !(block.numbers[name] > 0.0)) {
      map.error(block.place,
                fmt::format("scale is {}, not greater than zero", block.numbers[name]));
    }
  }
  try {
    (void)entry.parameters(block);
  } catch (const std::exception& e) {
    map.error(block.place, e.what());
  }
}

/// The keys of every block: sigma, loss, samples.
inline void read_block_weighting(ConfigMap& map, BlockConfig& block) {
  if (map.find("sigma") != nullptr) block.sigma = map.positive("sigma", 1.0);
  if (map.find("samples") != nullptr) {
    block.exclusive = read_choice(map, "samples", "all", {"all", "exclusive", "alone"}) != "all";
  }
  auto loss = map.map("loss", kErrorBlockItems.subject(block.name) + ": loss");
  if (!loss) return;
  if (loss->find("type") == nullptr) loss->error(loss->place(), "type is missing");
  block.loss.type = read_choice(*loss, "type", "none", {"none", "huber", "cauchy", "tukey"});
  block.loss.scale = loss->positive("scale", block.loss.scale);
  loss->report_unknown();
}

/// The entry of a block's type; nullptr, and an error, if the type is missing or unknown.
[[nodiscard]] inline const BlockEntry* find_block_entry(ConfigMap& map,
                                                        const SourceLocation& place) {
  const auto type = map.required_text("type");
  if (!type) return nullptr;
  if (const BlockEntry* entry = registry().block(*type)) return entry;
  std::vector<std::string> types;
  for (const BlockEntry& entry : registry().blocks()) types.push_back(entry.type);
  map.error(place, *type == "chain3d_to_mesh"
                       ? "type 'chain3d_to_mesh' is not supported in this version; distances of "
                         "points to a plane are: use chain3d_to_plane"
                       : "type '" + *type + "' is not an error block" + did_you_mean(*type, types));
  return nullptr;
}

/// Reads an error block and checks its models against those of the step.
[[nodiscard]] inline BlockConfig read_block(ConfigItem& item,
                                            const std::vector<ModelConfig>& models) {
  BlockConfig block;
  block.name = item.name;
  block.place = item.place;
  if (!item.map) return block;
  ConfigMap& map = *item.map;
  const BlockEntry* entry = find_block_entry(map, item.place);
  if (entry == nullptr) return block;
  block.type = entry->read_as;
  for (const BlockSensorEntry& of_block : entry->sensors) {
    read_block_model(map, of_block, models, block);
  }
  for (std::size_t i = 1; i < block.models.size(); ++i) {
    const auto end = block.models.begin() + static_cast<std::ptrdiff_t>(i);
    if (block.models[i].empty() || std::find(block.models.begin(), end, block.models[i]) == end) {
      continue;
    }
    map.error(item.place, "compares model '" + block.models[i] + "' with itself");
  }
  if (entry->has_param) block.param = map.required_text("param").value_or("");
  read_block_numbers(map, *entry, block);
  read_block_weighting(map, block);
  if (entry->type == "camera3d_to_ground") block.ground = map.text("ground").value_or("");
  // A fork describes its board here; lines of sight need none.
  if (entry->type == "camera2d_to_camera2d") map.ignore({"points_x", "points_y", "size"});
  map.report_unknown(!entry->is_upstream);
  return block;
}

}  // namespace kinecal::detail
