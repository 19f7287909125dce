// Definitions of read_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/read_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/config_free.ipp"
#include "kinecal/config/config_items.ipp"
#include "kinecal/config/registry.hpp"
#include "kinecal/config/ros2_nodes.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"

namespace kinecal {

namespace detail {
namespace {

// Reads the error blocks of a configuration; the registry has their types.

/// Reports a model that does not deliver the quantity the block takes.
void check_model_kind(const ConfigMap& map, const BlockConfig& block, const std::string& key,
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
void read_block_model(ConfigMap& map, const BlockSensorEntry& of_block,
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
void read_block_numbers(ConfigMap& map, const BlockEntry& entry, BlockConfig& block) {
  for (const auto& [name, fallback] : entry.numbers) {
    block.numbers[name] = map.number(name, fallback);
    if (map.find(name) != nullptr) block.given.insert(name);
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
void read_block_weighting(ConfigMap& map, BlockConfig& block) {
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
[[nodiscard]] const BlockEntry* find_block_entry(ConfigMap& map, const SourceLocation& place) {
  const auto type = map.required_text("type");
  if (!type) return nullptr;
  if (const BlockEntry* entry = registry().block(*type)) return entry;
  std::vector<std::string> types;
  for (const BlockEntry& entry : registry().blocks()) types.push_back(entry.type);
  map.error(place, "type '" + *type + "' is not an error block" + did_you_mean(*type, types));
  return nullptr;
}

/// The sensor of a block that stands for the surface of the robot; the end if it has none.
[[nodiscard]] auto of_surface(const BlockEntry& entry) {
  return std::find_if(entry.sensors.begin(), entry.sensors.end(),
                      [](const BlockSensorEntry& sensor) { return sensor.keys.empty(); });
}

/// The surface that a block compares with: `link_name`, `links` or `link_names`; `geometry`, `points`.
[[nodiscard]] SurfaceConfig read_surface_of(ConfigMap& map, const BlockConfig& block) {
  SurfaceConfig surface;
  const char* given = nullptr;
  for (const char* key : {"link_name", "links", "link_names"}) {
    const ConfigEntry* entry = map.find(key);
    if (entry == nullptr) continue;
    if (given != nullptr) {
      map.error(entry->place,
                fmt::format("'{}' and '{}' both name the links of the surface", given, key));
    }
    given = key;
    if (entry->value.is_list()) {
      for (const ConfigEntry& element : map.list(key)) {
        if (const auto name = config_text(element.value)) {
          surface.links.push_back(*name);
        } else {
          map.error(element.place, fmt::format("{}: {} is not the name of a link", key,
                                               describe_config(element.value)));
        }
      }
      if (surface.links.empty()) map.error(entry->place, fmt::format("{} has no link", key));
    } else if (const auto name = map.text(key)) {
      surface.links.push_back(*name);
    }
  }
  if (map.find("geometry") != nullptr) {
    surface.geometry = read_choice(map, "geometry", "visual", {"visual", "collision"});
  }
  surface.points = map.count("points", surface.points);
  if (surface.points < 1) map.error(block.place, "points is less than 1");
  return surface;
}

/// Adds the model that stands for the surface of the robot to each block that needs it.
void add_surface_models(ConfigMap& map, const std::string& base, StepConfig& step) {
  std::map<std::string, std::string> blocks;  // by camera
  for (BlockConfig& block : step.error_blocks) {
    if (!block.surface || block.models.empty()) continue;
    const std::string& camera = block.models.front();
    const auto [other, is_new] = blocks.emplace(camera, block.name);
    if (!is_new) {
      map.error(block.place, fmt::format("error block '{}': block '{}' compares '{}' with the "
                                         "surface of the robot already; list all links in one",
                                         block.name, other->second, camera));
    }
    ModelConfig surface{camera + "_surface", "chain3d", base, "", block.place};
    const auto is_taken = [&](const ModelConfig& model) { return model.name == surface.name; };
    while (std::any_of(step.models.begin(), step.models.end(), is_taken)) surface.name += "_";
    surface.param_name = surface.name;
    surface.links = block.surface->links;
    surface.is_surface = true;
    const BlockEntry& entry = *entry_of(block);
    block.models.insert(block.models.begin() + (of_surface(entry) - entry.sensors.begin()),
                        surface.name);
    step.models.push_back(std::move(surface));
  }
}

/// Reads an error block and checks its models against those of the step.
[[nodiscard]] BlockConfig read_block(ConfigItem& item, const std::vector<ModelConfig>& models) {
  BlockConfig block;
  block.name = item.name;
  block.place = item.place;
  if (!item.map) return block;
  ConfigMap& map = *item.map;
  const BlockEntry* entry = find_block_entry(map, item.place);
  if (entry == nullptr) return block;
  block.type = entry->read_as;
  for (const BlockSensorEntry& of_block : entry->sensors) {
    if (!of_block.keys.empty()) read_block_model(map, of_block, models, block);
  }
  for (std::size_t i = 1; i < block.models.size(); ++i) {
    const auto end = block.models.begin() + static_cast<std::ptrdiff_t>(i);
    if (block.models[i].empty() || std::find(block.models.begin(), end, block.models[i]) == end) {
      continue;
    }
    map.error(item.place, "compares model '" + block.models[i] + "' with itself");
  }
  if (of_surface(*entry) != entry->sensors.end()) block.surface = read_surface_of(map, block);
  if (entry->has_param) block.param = map.required_text("param").value_or("");
  read_block_numbers(map, *entry, block);
  read_block_weighting(map, block);
  if (entry->type == "camera3d_to_ground") block.ground = map.text("ground").value_or("");
  // A fork describes its board here; lines of sight need none.
  if (entry->type == "camera2d_to_camera2d") map.ignore({"points_x", "points_y", "size"});
  map.report_unknown(!entry->is_upstream);
  return block;
}

// The models of a configuration, in either dialect: their types, images and lenses.

/// Names of the types of models with the key `image`.
[[nodiscard]] std::string types_with_image() {
  std::string names;
  for (const SensorEntry& entry : registry().sensors()) {
    if (entry.has_image) names += (names.empty() ? "" : " and ") + entry.type;
  }
  return names;
}

/// `image: raw | rectified` of a camera that has images.
[[nodiscard]] ImageKind read_image(ConfigMap& map, const ModelConfig& model) {
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
[[nodiscard]] std::string read_lens(ConfigMap& map, const ModelConfig& model) {
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
[[nodiscard]] std::vector<std::string> model_types() {
  std::vector<std::string> types;
  for (const SensorEntry& entry : registry().sensors()) types.push_back(entry.type);
  types.emplace_back("chain");
  return types;
}

/// @return  the model; its type is empty if it is unknown
[[nodiscard]] ModelConfig read_model(ConfigItem& item) {
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

// One step of a configuration, in either dialect.

/// The configuration so far, and information for later steps.
struct ConfigProgress {
  Config config;
  FreeAxes free_axes;  ///< free in one of the steps so far
  NothingFree nothing_free = NothingFree::is_error;
};

/// Reads the settings of the file or of a step; returns max_num_iterations, or the fallback.
int read_settings(ConfigMap& map, int fallback, ConfigProgress& progress) {
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
void check_model_types(std::vector<ConfigItem>& items, StepConfig& step) {
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

/// Error blocks that look at joints and conditions only need no model.
[[nodiscard]] bool needs_model(const StepConfig& step) {
  const auto looks_at_none = [](const BlockConfig& block) {
    const BlockEntry* entry = entry_of(block);
    return entry != nullptr && entry->sensors.empty();
  };
  return step.error_blocks.empty() || !std::ranges::all_of(step.error_blocks, looks_at_none);
}

void check_step(ConfigMap& map, StepConfig& step, NothingFree nothing_free) {
  if (needs_model(step)) require_items(map, kModelItems);
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
void read_step(ConfigMap& map, const FindConfigItems& find, const std::string& name,
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
  add_surface_models(map, progress.config.base_link, step);
  step.initial_values = read_initial_values(map);
  step.initial_values.insert(step.initial_values.end(), fixed.begin(), fixed.end());
  step.bounds = read_bounds(map);
  check_step(map, step, progress.nothing_free);
  map.report_unknown();
  progress.config.steps.push_back(std::move(step));
}

/// initial_values and bounds of a file with several steps.  Values are set before the first step.
/// Bounds apply in every step that frees the parameter and has no bounds of its own for it.
void share_values(ConfigMap& map, ConfigProgress& progress) {
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

// The two dialects of configurations.
//
// ROS 1: the top-level keys are the only step, or `cal_steps` has several.  These run in
// alphabetical order, as ROS stores them.  A step without one of the lists inherits it from the
// previous step, the first step from the top-level keys: robot_calibration reads each step on top
// of the last one.  So each step also starts its free frames at the initial values.
//
// ROS 2: `<node>: ros__parameters:` with the steps listed in `calibration_steps`, in this order.

void read_ros1_steps(ConfigMap& file, ConfigMap& steps, ConfigProgress& progress) {
  const int max_num_iterations = read_settings(file, StepConfig{}.max_num_iterations, progress);
  std::set<std::string> names;
  for (const ConfigEntry& entry : steps.entries()) names.insert(entry.key);
  if (names.empty()) file.error(steps.place(), "cal_steps has no steps");
  std::vector<ConfigMap> maps;
  for (const std::string& name : names) {
    auto step = steps.map(*steps.use(name), "step '" + name + "'");
    if (!step) continue;
    step->inherit(maps.empty() ? file : maps.back(),
                  {"models", "free_params", "free_frames", "fixed_frames",
                   "free_frames_initial_values", "error_blocks"});
    read_step(*step, find_ros1_items, name, max_num_iterations, progress);
    maps.push_back(std::move(*step));
  }
  share_values(file, progress);
}

void read_ros1(ConfigMap& file, ConfigProgress& progress) {
  const ConfigEntry* entry = file.find("cal_steps");
  if (entry == nullptr) {
    read_step(file, find_ros1_items, "calibrate", StepConfig{}.max_num_iterations, progress);
    return;
  }
  if (auto steps = file.map(*entry, "cal_steps")) read_ros1_steps(file, *steps, progress);
  file.report_unknown();
}

/// The names in `calibration_steps`, each as the key of its entry.
[[nodiscard]] std::vector<ConfigEntry> ros2_step_names(ConfigMap& parameters) {
  std::vector<ConfigEntry> names;
  for (const ConfigEntry& element : parameters.list("calibration_steps")) {
    const auto name = config_text(element.value);
    if (!name) {
      parameters.error(element.place, "calibration_steps: " + describe_config(element.value) +
                                          " is not a name of a step");
      continue;
    }
    const auto has_name = [&](const ConfigEntry& entry) { return entry.key == *name; };
    const auto first = std::find_if(names.begin(), names.end(), has_name);
    if (first == names.end()) {
      names.push_back({*name, element.value, element.place});
    } else {
      parameters.error(element.place, "step '" + *name + "' occurs twice; the first is in line " +
                                          std::to_string(first->place.line));
    }
  }
  return names;
}

void read_ros2_steps(ConfigMap& parameters, int max_num_iterations, ConfigProgress& progress) {
  const std::vector<ConfigEntry> names = ros2_step_names(parameters);
  std::set<std::string> others;  // maps that are not listed as steps; one may be a misspelt step
  for (const ConfigEntry& entry : parameters.entries()) {
    if (entry.value.is_map()) others.insert(entry.key);
  }
  for (const ConfigEntry& name : names) others.erase(name.key);
  for (const ConfigEntry& name : names) {
    if (const ConfigEntry* entry = parameters.use(name.key)) {
      auto step = parameters.map(*entry, "step '" + name.key + "'");
      if (step) read_step(*step, FindRos2Items(), name.key, max_num_iterations, progress);
      continue;
    }
    const std::string meant = parameters.did_you_mean(name.key, others);
    parameters.error(name.place, "step '" + name.key + "' has no map '" + name.key +
                                     "' beside calibration_steps" + meant);
    if (!meant.empty()) parameters.use(*nearest_name(name.key, others));
  }
}

/// @param parameters  the map under ros__parameters
void read_ros2(ConfigMap& parameters, ConfigProgress& progress) {
  parameters.ignore({"use_sim_time", "start_type_description_service"});  // of every node
  // Of the capture, which may be in the same file.
  parameters.ignore({"duration", "velocity_factor", "settling_timeout", "qos_overrides"});
  for (const char* list : {"chains", "features"}) {
    for (const ConfigEntry& element : parameters.list(list)) {
      if (const auto name = config_text(element.value)) parameters.use(*name);
    }
  }
  const int iterations = read_settings(parameters, StepConfig{}.max_num_iterations, progress);
  require_items(parameters, {"calibration_steps", "step", ""});
  read_ros2_steps(parameters, iterations, progress);
  share_values(parameters, progress);
  parameters.report_unknown();
}

/// Reports a `ros__parameters` that is missing above calibration_steps, or misspelt.
/// @return  true if so
bool misses_ros_parameters(const ConfigMap& file) {
  if (const ConfigEntry* steps = file.peek("calibration_steps")) {
    file.error(steps->place, "calibration_steps stands outside of '<node>: ros__parameters:'");
    return true;
  }
  const std::vector<std::string> expected = {"ros__parameters"};
  for (const ConfigEntry& node : file.entries()) {
    for (const YamlNode& key : node.value.keys) {
      const std::string meant = did_you_mean(key.text, expected);
      if (meant.empty()) continue;
      file.error({file.place().file, key.line},
                 "unknown key '" + key.text + "' of node '" + node.key + "'" + meant);
      return true;
    }
  }
  return false;
}

/// Reports keys that are one level too deep, below the name of a node or of a namespace.
/// @return  true if so
bool is_too_deep(const ConfigMap& file) {
  const std::vector<std::string> known = {"cal_steps", "models", "free_params", "free_frames",
                                          "error_blocks"};
  const auto stands_in = [](const auto& map) {
    return [&map](const std::string& key) { return map(key) != nullptr; };
  };
  const auto at_top = [&](const std::string& key) { return file.peek(key); };
  if (std::any_of(known.begin(), known.end(), stands_in(at_top))) return false;
  for (const ConfigEntry& entry : file.entries()) {
    const std::string below = "below '" + entry.key + "'";
    const auto deeper = [&](const std::string& key) { return entry.value.find(key); };
    if (deeper("calibration_steps") != nullptr) {
      file.error(entry.place,
                 "calibration_steps is " + below + "; add 'ros__parameters:' between the two");
    } else if (std::any_of(known.begin(), known.end(), stands_in(deeper))) {
      file.error(entry.place, "the keys are " + below + "; move them to the top");
    } else {
      continue;
    }
    return true;
  }
  return false;
}

/// Reads the file's top-level map in its dialect: ROS 2 with `ros__parameters`, ROS 1 without.
/// @param content  the map
void read_dialect(const YamlNode& content, ConfigMap& file, ConfigProgress& progress) {
  const std::vector<ConfigEntry> nodes = ros2_nodes(content, file.place().file);
  if (nodes.empty()) {
    if (!misses_ros_parameters(file) && !is_too_deep(file)) read_ros1(file, progress);
    return;
  }
  for (const ConfigEntry& entry : nodes) file.use(entry.key.substr(0, entry.key.find('/')));
  for (const ConfigEntry& entry : nodes) file.use(entry.key);
  const ConfigEntry* chosen = choose_node(nodes, "calibration_steps", file.diagnostics());
  if (chosen == nullptr) return;
  ConfigMap node(chosen->value, chosen->place, "node '" + chosen->key + "'", file.diagnostics());
  if (auto parameters = node.map(*node.find("ros__parameters"), "")) {
    read_ros2(*parameters, progress);
  }
  node.report_unknown();
  file.report_unknown();
}

/// Appends messages, each once: steps that share a list report the same errors.
void add_once(std::vector<std::string>& messages, const std::vector<std::string>& more) {
  std::set<std::string> added;
  for (const std::string& message : more) {
    if (added.insert(message).second) messages.push_back(message);
  }
}

}  // namespace
}  // namespace detail

Config read_config(const std::string& path, Diagnostics& diagnostics) {
  return parse_config(detail::read_yaml_text(path), path, diagnostics);
}

Config parse_config(const std::string& text, const std::string& path, Diagnostics& diagnostics,
                    NothingFree nothing_free) {
  detail::ConfigProgress progress;
  progress.nothing_free = nothing_free;
  progress.config.place = {path, 0};
  Diagnostics found;
  const detail::YamlNode content = detail::parse_config_text(text, path, found);
  if (content.is_map()) {
    detail::ConfigMap file(content, {path, 0}, "", found);
    detail::read_dialect(content, file, progress);
  } else {
    found.error({path, 0}, detail::describe_wrong_file(content, "a configuration"));
  }
  const std::vector<StepConfig>& steps = progress.config.steps;
  const auto is_empty = [](const StepConfig& step) { return free_parameters(step).empty(); };
  const bool all_empty = std::all_of(steps.begin(), steps.end(), is_empty);
  for (const StepConfig& step : steps) {  // a search is for all or for none
    if (all_empty || !is_empty(step) || nothing_free != NothingFree::without_lists) continue;
    found.error(step.place, "nothing is free in step '" + step.name +
                                "'; name parameters under 'free_params' or frames under "
                                "'free_frames'");
  }
  detail::add_once(diagnostics.errors, found.errors);
  detail::add_once(diagnostics.warnings, found.warnings);
  return progress.config;
}

}  // namespace kinecal
