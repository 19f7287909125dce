// The models of a configuration, in either dialect: their types, images and lenses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/config/config_blocks.ipp"

namespace kinecal::detail {

/// Names of the types of models with the key `image`.
[[nodiscard]] inline std::string types_with_image() {
  std::string names;
  for (const SensorEntry& entry : registry().sensors()) {
    if (entry.has_image) names += (names.empty() ? "" : " and ") + entry.type;
  }
  return names;
}

/// `image: raw | rectified` of a camera that has images.
[[nodiscard]] inline ImageKind read_image(ConfigMap& map, const ModelConfig& model) {
  const auto image = map.text("image");
  if (!image) return ImageKind::automatic;
  const SourceLocation place = map.find("image")->place;
  if (const auto* entry = entry_of(model); entry != nullptr && !entry->has_image) {
    map.error(place,
              "image is a key of " + types_with_image() + ", but the type is '" + model.type + "'");
  }
  if (*image == "raw") return ImageKind::raw;
  if (*image == "rectified") return ImageKind::rectified;
  map.error(place, "image '" + *image + "' is neither raw nor rectified" +
                       did_you_mean(*image, std::vector<std::string>{"raw", "rectified"}));
  return ImageKind::automatic;
}

/// `lens: equidistant`, or another name of a lens that the type has, or auto.
[[nodiscard]] inline std::string read_lens(ConfigMap& map, const ModelConfig& model) {
  const auto lens = map.text("lens");
  if (!lens) return {};
  const SourceLocation place = map.find("lens")->place;
  const SensorEntry* entry = entry_of(model);
  if (entry != nullptr && entry->lenses.empty()) {
    map.error(place, "lens is a key of camera2d, but the type is '" + model.type + "'");
  }
  std::vector<std::string> names(lens_names().begin(), lens_names().end());
  if (entry != nullptr && !entry->lenses.empty()) names = entry->lenses;
  names.emplace_back(kAnyLens);
  const bool is_one = std::find(names.begin(), names.end(), *lens) != names.end();
  const std::string known(is_one ? *lens : lens_named(*lens));
  if (known.empty()) {
    map.error(place, fmt::format("lens '{}' is none of {}{}", *lens, fmt::join(names, ", "),
                                 did_you_mean(*lens, names)));
  }
  return known;
}

/// Names of the types of models.
[[nodiscard]] inline std::vector<std::string> model_types() {
  std::vector<std::string> types;
  for (const SensorEntry& entry : registry().sensors()) types.push_back(entry.type);
  types.emplace_back("chain");
  return types;
}

/// @return  the model; its type is empty if it is unknown
[[nodiscard]] inline ModelConfig read_model(ConfigItem& item) {
  ModelConfig model{item.name, "", "", item.name, item.place, ImageKind::automatic, {}};
  if (!item.map) return model;
  ConfigMap& map = *item.map;
  const std::vector<std::string> types = model_types();
  const std::string type = map.required_text("type").value_or("");
  const std::string meant = did_you_mean(type, types);
  if (std::find(types.begin(), types.end(), type) != types.end()) {
    model.type = type == "chain" ? "chain3d" : type;
  } else if (!meant.empty()) {
    map.error(map.find("type")->place, "type '" + type + "' is not a model" + meant);
  }
  model.frame = map.required_text("frame").value_or("");
  model.param_name = map.text("param_name").value_or(item.name);
  model.image = read_image(map, model);
  model.lens = read_lens(map, model);
  map.ignore({"topic", "camera_info_topic"});  // used for recording samples
  map.report_unknown();
  return model;
}

}  // namespace kinecal::detail
