// A sample as the content of a robot_calibration_msgs/CalibrationData message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <utility>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/results/output_file.hpp"
#include "kinecal/files/samples/feature_id_parameters.ipp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

[[nodiscard]] inline MessageFields feature_message(const Feature& feature) {
  if (feature.rotation) {
    throw OutputError("a message of samples cannot hold the orientation of a feature; write YAML");
  }
  if (feature.sigma) {
    throw OutputError("a message of samples cannot hold the sigma of a feature; write YAML");
  }
  const auto& p = feature.point;
  return fields("header", fields("frame_id", std::string_view(feature.frame)), "point",
                fields("x", p.x(), "y", p.y(), "z", p.z()));
}

[[nodiscard]] inline MessageFields camera_message(const CameraInfo& camera) {
  MessageFields info =
      fields("height", static_cast<std::int64_t>(camera.height), "width",
             static_cast<std::int64_t>(camera.width), "distortion_model",
             std::string_view(camera.distortion_model), "d", numbers(camera.d), "k",
             numbers(camera.k), "r", numbers(camera.r), "p", numbers(camera.p));
  return fields("camera_info", std::move(info));
}

/// The depth driver's parameters and the ids of features: see feature_id_parameters.ipp.
/// @param texts  keeps the names that the message refers to
[[nodiscard]] inline MessageValue::List parameters_message(const Observation& seen,
                                                           std::deque<std::string>& texts) {
  MessageValue::List parameters;
  if (seen.camera) {
    const double offset = *number_from_yaml(millimetres_from_metres(seen.camera->z_offset));
    parameters.emplace_back(fields("name", std::string_view("z_offset_mm"), "value", offset));
    parameters.emplace_back(
        fields("name", std::string_view("z_scaling"), "value", seen.camera->z_scaling));
  }
  for (const auto& [name, id] : feature_id_parameters(seen.features)) {
    texts.push_back(name);
    parameters.emplace_back(fields("name", std::string_view(texts.back()), "value", id));
  }
  return parameters;
}

[[nodiscard]] inline MessageFields observation_message(const Observation& seen,
                                                       std::deque<std::string>& texts) {
  MessageFields message =
      fields("sensor_name", std::string_view(seen.sensor), "features",
             list_of(seen.features, [](const Feature& f) { return feature_message(f); }));
  MessageValue::List parameters = parameters_message(seen, texts);
  if (!seen.camera && parameters.empty()) return message;
  MessageFields camera = seen.camera ? camera_message(*seen.camera) : MessageFields{};
  camera.fields.emplace_back("parameters", std::move(parameters));
  message.fields.emplace_back("ext_camera_info", std::move(camera));
  return message;
}

/// @param texts  keeps names; like the sample, must outlive the message, which refers to them
[[nodiscard]] inline MessageFields sample_message(const Sample& sample,
                                                  std::deque<std::string>& texts) {
  const auto has_some = [](const auto& of) { return !of.conditions.empty(); };
  const bool of_features =
      std::any_of(sample.observations.begin(), sample.observations.end(), [&](const auto& seen) {
        return std::any_of(seen.features.begin(), seen.features.end(), has_some);
      });
  if (has_some(sample) || of_features) {
    throw OutputError("a message of samples cannot hold conditions; write YAML");
  }
  if (!sample.poses.empty()) {
    throw OutputError("a message of samples cannot hold measured poses; write YAML");
  }
  MessageFields joints = fields("name", detail::texts(sample.joint_names), "position",
                                numbers(sample.joint_positions));
  if (!sample.joint_velocities.empty()) {
    joints.fields.emplace_back("velocity", numbers(sample.joint_velocities));
  }
  if (sample.stamp && sample.stamp->count() >= 0) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    joints.fields.emplace_back(
        "header", fields("stamp", fields("secs", sample.stamp->count() / kSecond, "nsecs",
                                         sample.stamp->count() % kSecond)));
  }
  return fields("joint_states", std::move(joints), "observations",
                list_of(sample.observations,
                        [&](const Observation& seen) { return observation_message(seen, texts); }));
}

}  // namespace kinecal::detail
