// Error blocks of a configuration: a table with a row for each type, and their reader.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/config/config.hpp"
#include "kinecal/io/config/config_items.ipp"

namespace kinecal {

/// The keys of a type of error block.
struct BlockForm {
  std::string type;                                     ///< in the file
  std::string read_as;                                  ///< BlockConfig::type
  std::vector<std::vector<std::string>> models;         ///< keys of each model, the usual one first
  std::vector<std::pair<std::string, double>> numbers;  ///< keys and defaults
  bool has_param = false;
};

/// All types.  The defaults of a plane are the ground, z = 0 of the base link.
[[nodiscard]] inline const std::vector<BlockForm>& block_forms() {
  static const std::vector<std::pair<std::string, double>> plane = {
      {"a", 0.0}, {"b", 0.0}, {"c", 1.0}, {"d", 0.0}, {"scale", 1.0}};
  static const std::vector<BlockForm> forms = {
      {"chain3d_to_chain3d", "chain3d_to_chain3d", {{"model_a"}, {"model_b"}}, {}},
      {"camera3d_to_arm", "chain3d_to_chain3d", {{"camera", "model_a"}, {"arm", "model_b"}}, {}},
      {"chain3d_to_camera2d",
       "chain3d_to_camera2d",
       {{"model_3d"}, {"model_2d"}},
       {{"scale", 1.0}}},
      {"chain3d_to_plane", "chain3d_to_plane", {{"model", "model_a"}}, plane},
      {"camera3d_to_ground", "chain3d_to_plane", {{"camera", "model_a", "model"}}, plane},
      {"plane_to_plane",
       "plane_to_plane",
       {{"model_a"}, {"model_b"}},
       {{"normal_scale", 1.0}, {"offset_scale", 1.0}}},
      {"outrageous",
       "outrageous",
       {},
       {{"joint_scale", 1.0}, {"position_scale", 1.0}, {"rotation_scale", 1.0}},
       true}};
  return forms;
}

/// Reports a model that observes points where the block needs pixels, or the reverse.
inline void check_model_kind(const ConfigMap& map, const BlockConfig& block, const std::string& key,
                             const ModelConfig& model) {
  const bool pixels_expected = block.type == "chain3d_to_camera2d" && block.models.size() == 2;
  if (model.type.empty() || (model.type == "camera2d") == pixels_expected) return;
  const std::string is = key + " '" + model.name + "' is a " + model.type;
  map.error(block.place, pixels_expected
                             ? is + "; it must be a camera2d, which observes pixels"
                             : is + "; it must be a chain3d or camera3d, which observe points");
}

/// Reads one model of a block, under whichever of its keys the file has.
inline void read_block_model(ConfigMap& map, const std::vector<std::string>& keys,
                             const std::vector<ModelConfig>& models, BlockConfig& block) {
  const ConfigEntry* entry = nullptr;
  for (const std::string& key : keys) {
    const ConfigEntry* candidate = map.find(key);
    if (candidate != nullptr && entry != nullptr) {
      map.error(candidate->place, "'" + entry->key + "' and '" + key + "' are the same model");
    } else if (candidate != nullptr) {
      entry = candidate;
    }
  }
  const std::string key = entry == nullptr ? keys.front() : entry->key;
  const auto name = map.required_text(key);
  block.models.push_back(name.value_or(""));
  if (!name) return;
  std::vector<std::string> names;
  for (const ModelConfig& model : models) {
    if (model.name == *name) return check_model_kind(map, block, key, model);
    names.push_back(model.name);
  }
  map.error(block.place, key + " '" + *name + "' is not a model" + map.did_you_mean(*name, names));
}

inline void read_block_numbers(ConfigMap& map, const BlockForm& form, BlockConfig& block) {
  for (const auto& [name, fallback] : form.numbers) {
    block.numbers[name] = map.number(name, fallback);
  }
  if (block.type != "chain3d_to_plane") return;
  const double length = std::hypot(block.numbers["a"], block.numbers["b"], block.numbers["c"]);
  if (!(length > 0.0)) map.error(block.place, "the plane's normal (a, b, c) has length zero");
}

/// One of a few words; the fallback, and an error, for any other.
inline std::string read_choice(ConfigMap& map, const std::string& key, const std::string& fallback,
                               const std::vector<std::string>& choices) {
  std::string word = map.text(key).value_or(fallback);
  std::string all;
  for (const std::string& choice : choices) {
    if (choice == word) return word;
    all += (all.empty() ? "" : ", ") + choice;
  }
  map.error(map.find(key)->place,
            key + " '" + word + "' is not one of " + all + did_you_mean(word, choices));
  return fallback;
}

/// The keys of every block: sigma, loss, samples.
inline void read_block_weighting(ConfigMap& map, BlockConfig& block) {
  block.sigma = map.positive("sigma", block.sigma);
  block.alone = read_choice(map, "samples", "all", {"all", "alone"}) == "alone";
  auto loss = map.map("loss", kErrorBlockItems.subject(block.name) + ": loss");
  if (!loss) return;
  if (loss->find("type") == nullptr) loss->error(loss->place(), "type is missing");
  block.loss.type = read_choice(*loss, "type", "none", {"none", "huber", "cauchy", "tukey"});
  block.loss.scale = loss->positive("scale", block.loss.scale);
  loss->report_unknown();
}

/// The form of a block's type; nullptr, and an error, if the type is missing or unknown.
[[nodiscard]] inline const BlockForm* find_block_form(ConfigMap& map, const Place& place) {
  const auto type = map.required_text("type");
  if (!type) return nullptr;
  std::vector<std::string> types;
  for (const BlockForm& form : block_forms()) {
    if (form.type == *type) return &form;
    types.push_back(form.type);
  }
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
  const BlockForm* form = find_block_form(map, item.place);
  if (form == nullptr) return block;
  block.type = form->read_as;
  for (const auto& keys : form->models) read_block_model(map, keys, models, block);
  if (block.models.size() == 2 && block.models[0] == block.models[1] && !block.models[0].empty()) {
    map.error(item.place, "compares model '" + block.models[0] + "' with itself");
  }
  if (form->has_param) block.param = map.required_text("param").value_or("");
  read_block_numbers(map, *form, block);
  read_block_weighting(map, block);
  if (form->type == "camera3d_to_ground") block.ground = map.text("ground").value_or("");
  map.report_unknown();
  return block;
}

}  // namespace kinecal
