// Definitions of own_frames.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/own_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// True if features of a model are in a frame.
[[nodiscard]] bool has_features_in(const std::string& frame, const ModelConfig& model,
                                   std::span<const Sample> samples) {
  return std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
    const Observation* seen = sample.observation(model.name);
    return seen != nullptr &&
           std::any_of(seen->features.begin(), seen->features.end(), [&](const Feature& feature) {
             return plain_frame(feature.frame) == plain_frame(frame);
           });
  });
}

/// Gives the models with features in a frame its link.
/// @returns  the link on which they stood, the base for a model in the frame itself; empty if absent
[[nodiscard]] std::string move_models(Config& config, const std::string& frame,
                                      std::span<const Sample> samples) {
  std::string parent;
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      if (sensor_entry(model).sensor->in_own_frame()) continue;
      if (!has_features_in(frame, model, samples)) continue;
      parent = model.frame == frame ? config.base_link : model.frame;
      model.frame = frame;
    }
  }
  return parent;
}

/// Reports a frame that is free in a step, too.
void check_held(const Config& config, const FreeParamConfig& frame, Diagnostics& diagnostics) {
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& free : step.free_frames) {
      if (free.name != frame.name) continue;
      diagnostics.error(free.place,
                        fmt::format("frame '{}' has a pose of its own in each sample by "
                                    "per_sample; it cannot be free as well",
                                    frame.name));
    }
  }
}

}  // namespace
}  // namespace detail

Robot with_own_frames(const Robot& robot, Config& config, std::span<const Sample> samples,
                      Diagnostics& diagnostics) {
  std::vector<Joint> joints = robot.joints();
  for (const FreeParamConfig& frame : config.per_sample) {
    detail::check_held(config, frame, diagnostics);
    const auto joint = std::find_if(joints.begin(), joints.end(),
                                    [&](const Joint& one) { return one.name == frame.name; });
    if (joint != joints.end()) {
      if (joint->type == JointType::fixed) joint->type = JointType::floating;
      if (joint->type == JointType::floating) continue;
      diagnostics.error(frame.place,
                        fmt::format("per_sample: joint '{}' is {}; only a fixed or floating joint "
                                    "can have a pose of its own in each sample",
                                    frame.name, to_string(joint->type)));
      continue;
    }
    if (frame.name == config.base_link) {
      diagnostics.error(frame.place,
                        fmt::format("per_sample: '{}' is the base_link, in which measurements are "
                                    "compared; it has no pose of its own in each sample",
                                    frame.name));
      continue;
    }
    const std::string parent = detail::move_models(config, frame.name, samples);
    if (parent.empty()) {
      const std::set<std::string> recorded = detail::feature_frames(samples);
      std::vector<std::string> known(recorded.begin(), recorded.end());
      for (const Joint& one : joints) known.push_back(one.name);
      diagnostics.error(
          frame.place,
          fmt::format("per_sample: '{}' is neither a joint of the robot nor a frame in which "
                      "features of a chain3d or chain6d are{}",
                      frame.name, did_you_mean(frame.name, known)));
      continue;
    }
    joints.push_back({frame.name, JointType::floating, parent, frame.name, {}, {}, {}, {}});
  }
  return config.per_sample.empty() ? robot : Robot(robot.name(), std::move(joints));
}

std::string urdf_of_cameras(const Config& config) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- Cameras on a body, and what they look at. -->\n"
      "<robot name=\"cameras\">\n  <link name=\"{}\"/>\n",
      config.base_link);
  std::set<std::string> links = {config.base_link};
  for (const ModelConfig& model : detail::models_of(config)) {
    if (!links.insert(model.frame).second) continue;
    const bool floats = std::any_of(config.per_sample.begin(), config.per_sample.end(),
                                    [&](const auto& frame) { return frame.name == model.frame; });
    text += fmt::format(
        "  <link name=\"{0}\"/>\n  <joint name=\"{1}\" type=\"{2}\">\n    <parent "
        "link=\"{3}\"/>\n    <child link=\"{0}\"/>\n    <origin xyz=\"0 0 0\" rpy=\"0 0 "
        "0\"/>\n  </joint>\n",
        model.frame, floats ? model.frame : model.frame + "_joint", floats ? "floating" : "fixed",
        config.base_link);
  }
  return text + "</robot>\n";
}

}  // namespace kinecal
