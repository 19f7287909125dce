// Definitions of config_to_yaml.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/config_to_yaml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "kinecal/config/config_free.ipp"
#include "kinecal/config/registry.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/geometry/rpy.hpp"

namespace kinecal {

namespace detail {
namespace {

using Comments = std::map<std::string, std::string>;

[[nodiscard]] std::string comment_of(const Comments& why, const std::string& name) {
  const auto found = why.find(name);
  return found == why.end() ? "" : "  # " + found->second;
}

/// "  # x: held out 0.2 mm -> 0.1 mm; roll: ..."
[[nodiscard]] std::string comment_of_axes(const Comments& why, const FreeFrameConfig& frame) {
  std::string text;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto found = why.find(parameter_name(frame.name, kFrameAxes[i]));
    if (!frame.axes[i] || found == why.end()) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "  # " : "; ", kConfigAxes[i], found->second);
  }
  return text;
}

[[nodiscard]] std::string per_sample_text(const Config& config) {
  std::string text;
  for (const FreeParamConfig& frame : config.per_sample) {
    text += (text.empty() ? "" : ", ") + name_to_yaml(frame.name);
  }
  return text.empty() ? "" : "per_sample: [" + text + "]\n";
}

[[nodiscard]] std::string models_text(const StepConfig& step) {
  std::string text = "\nmodels:\n";
  for (const ModelConfig& model : step.models) {
    if (model.is_surface) continue;
    text += fmt::format(" - name: {}\n   type: {}\n   frame: {}\n", name_to_yaml(model.name),
                        name_to_yaml(model.type), name_to_yaml(model.frame));
    if (model.param_name != model.name) {
      text += "   param_name: " + name_to_yaml(model.param_name) + "\n";
    }
    if (model.image != ImageKind::automatic) {
      text += model.image == ImageKind::raw ? "   image: raw\n" : "   image: rectified\n";
    }
    if (!model.lens.empty()) text += "   lens: " + model.lens + "\n";
  }
  return text;
}

[[nodiscard]] std::string pose_text(const std::string& name, const Vector3<double>& xyz,
                                    const Vector3<double>& rpy) {
  std::string text = " - {name: " + name_to_yaml(name);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    text += fmt::format(", {}: {}", kConfigAxes[i], number_to_yaml(i < 3 ? xyz(axis) : rpy(axis)));
  }
  return text + "}\n";
}

/// The pose of a fixed frame, which the reader keeps as initial values of its six parameters.
[[nodiscard]] std::string fixed_frame_text(const StepConfig& step, const std::string& name) {
  Eigen::Matrix<double, 6, 1> pose = Eigen::Matrix<double, 6, 1>::Zero();
  for (const InitialValueConfig& value : step.initial_values) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (value.name == parameter_name(name, kFrameAxes[i]))
        pose(static_cast<Eigen::Index>(i)) = value.value;
    }
  }
  return pose_text(name, pose.head<3>(), rpy_from_rotation(exp(Vector3<double>(pose.tail<3>()))));
}

[[nodiscard]] std::string free_text(const StepConfig& step, const Comments& why) {
  std::string parameters, frames, fixed, initial;
  for (const FreeParamConfig& parameter : step.free_params) {
    parameters += " - " + name_to_yaml(parameter.name) + comment_of(why, parameter.name) + "\n";
  }
  for (const FreeFrameConfig& frame : step.free_frames) {
    if (frame.is_fixed) {
      fixed += fixed_frame_text(step, frame.name);
      continue;
    }
    frames += " - {name: " + name_to_yaml(frame.name);
    for (std::size_t i = 0; i < 6; ++i) {
      frames += fmt::format(", {}: {}", kConfigAxes[i], frame.axes[i]);
    }
    frames += "}" + comment_of_axes(why, frame) + "\n";
  }
  for (const FrameInitialValueConfig& frame : step.frame_initial_values) {
    initial += pose_text(frame.name, frame.xyz, frame.rpy);
  }
  std::string text;
  const auto add = [&](const char* key, const std::string& list) {
    if (!list.empty()) text += fmt::format("\n{}:\n{}", key, list);
  };
  add("free_params", parameters);
  add("free_frames", frames);
  add("fixed_frames", fixed);
  add("free_frames_initial_values", initial);
  return text;
}

/// True if a value is one of the pose of a fixed frame.
[[nodiscard]] bool is_of_fixed(const StepConfig& step, const std::string& name) {
  return std::any_of(step.free_frames.begin(), step.free_frames.end(), [&](const auto& frame) {
    return frame.is_fixed &&
           std::any_of(kFrameAxes.begin(), kFrameAxes.end(),
                       [&](const auto axis) { return parameter_name(frame.name, axis) == name; });
  });
}

[[nodiscard]] std::string numbers_text(const StepConfig& step) {
  std::string values, bounds;
  for (const InitialValueConfig& value : step.initial_values) {
    if (is_of_fixed(step, value.name)) continue;
    values += fmt::format("  {}: {}\n", name_to_yaml(value.name), number_to_yaml(value.value));
  }
  for (const BoundConfig& bound : step.bounds) {
    bounds += fmt::format("  {}: [{}, {}]\n", name_to_yaml(bound.name), number_to_yaml(bound.lower),
                          number_to_yaml(bound.upper));
  }
  return (values.empty() ? "" : "\ninitial_values:\n" + values) +
         (bounds.empty() ? "" : "\nbounds:\n" + bounds);
}

/// @param add  takes a key and its value
template <class Add>
void add_surface(const SurfaceConfig& surface, const Add& add) {
  std::string links;
  for (const std::string& link : surface.links) {
    links += (links.empty() ? "" : ", ") + name_to_yaml(link);
  }
  if (!links.empty()) add("links", "[" + links + "]");
  if (!surface.geometry.empty()) add("geometry", surface.geometry);
  if (surface.points != SurfaceConfig{}.points) add("points", std::to_string(surface.points));
}

[[nodiscard]] std::string block_text(const BlockConfig& block) {
  std::string text =
      fmt::format(" - name: {}\n   type: {}\n", name_to_yaml(block.name), name_to_yaml(block.type));
  const auto add = [&](std::string_view key, const std::string& value) {
    text += fmt::format("   {}: {}\n", key, value);
  };
  const BlockEntry* entry = entry_of(block);
  if (entry != nullptr) {
    for (std::size_t i = 0; i < std::min(entry->sensors.size(), block.models.size()); ++i) {
      const std::vector<std::string>& keys = entry->sensors[i].keys;
      if (!keys.empty()) add(keys.front(), name_to_yaml(block.models[i]));
    }
    for (const auto& [key, usual] : entry->numbers) {
      const auto number = block.numbers.find(key);
      if (number != block.numbers.end() && number->second != usual)
        add(key, number_to_yaml(number->second));
    }
  }
  if (!block.param.empty()) add("param", name_to_yaml(block.param));
  if (!block.ground.empty()) add("ground", name_to_yaml(block.ground));
  if (block.surface) add_surface(*block.surface, add);
  if (block.exclusive) add("samples", *block.exclusive ? "exclusive" : "all");
  if (block.sigma) add("sigma", number_to_yaml(*block.sigma));
  if (block.loss.type != "none") {
    add("loss",
        fmt::format("{{type: {}, scale: {}}}", block.loss.type, number_to_yaml(block.loss.scale)));
  }
  return text;
}

}  // namespace
}  // namespace detail

std::string config_to_yaml(const Config& config, const std::string& title,
                           const std::map<std::string, std::string>& why) {
  if (config.steps.size() != 1) {
    throw std::invalid_argument("only a configuration of one step can be written");
  }
  const StepConfig& step = config.steps.front();
  std::string text;
  for (std::size_t at = 0; at < title.size();) {
    const std::size_t end = std::min(title.find('\n', at), title.size());
    text += "# " + title.substr(at, end - at) + "\n";
    at = end + 1;
  }
  text += fmt::format("\nbase_link: {}\nmax_num_iterations: {}\n",
                      detail::name_to_yaml(config.base_link), step.max_num_iterations) +
          detail::per_sample_text(config);
  if (config.gravity) {
    const Vector3<double>& g = *config.gravity;
    text += fmt::format("gravity: {{x: {}, y: {}, z: {}}}\n", number_to_yaml(g.x()),
                        number_to_yaml(g.y()), number_to_yaml(g.z()));
  }
  if (!config.payload_link.empty())
    text += fmt::format("payload_link: {}\n", detail::name_to_yaml(config.payload_link));
  text += detail::models_text(step) + detail::free_text(step, why) + detail::numbers_text(step);
  text += "\nerror_blocks:\n";
  for (const BlockConfig& block : step.error_blocks) text += detail::block_text(block);
  return text;
}

}  // namespace kinecal
