// A sample as the content of a robot_calibration_msgs/CalibrationData message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "kinecal/io/messages/make.ipp"
#include "kinecal/io/results/output_file.hpp"
#include "kinecal/io/yaml/yaml_text.hpp"
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
  const double offset = *number_from_yaml(millimetres_from_metres(camera.z_offset));
  MessageFields info =
      fields("height", static_cast<std::int64_t>(camera.height), "width",
             static_cast<std::int64_t>(camera.width), "distortion_model",
             std::string_view(camera.distortion_model), "d", numbers(camera.d), "k",
             numbers(camera.k), "r", numbers(camera.r), "p", numbers(camera.p));
  MessageValue::List parameters;
  parameters.emplace_back(fields("name", std::string_view("z_offset_mm"), "value", offset));
  parameters.emplace_back(fields("name", std::string_view("z_scaling"), "value", camera.z_scaling));
  return fields("camera_info", std::move(info), "parameters", std::move(parameters));
}

[[nodiscard]] inline MessageFields observation_message(const Observation& seen) {
  MessageFields message =
      fields("sensor_name", std::string_view(seen.sensor), "features",
             list_of(seen.features, [](const Feature& f) { return feature_message(f); }));
  if (seen.camera) message.fields.emplace_back("ext_camera_info", camera_message(*seen.camera));
  return message;
}

/// @return  views of the sample, which must outlive it
[[nodiscard]] inline MessageFields sample_message(const Sample& sample) {
  if (!sample.conditions.empty()) {
    throw OutputError("a message of samples cannot hold conditions; write YAML");
  }
  MessageFields joints =
      fields("name", texts(sample.joint_names), "position", numbers(sample.joint_positions));
  if (sample.stamp && sample.stamp->count() >= 0) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    joints.fields.emplace_back(
        "header", fields("stamp", fields("secs", sample.stamp->count() / kSecond, "nsecs",
                                         sample.stamp->count() % kSecond)));
  }
  return fields("joint_states", std::move(joints), "observations",
                list_of(sample.observations,
                        [](const Observation& seen) { return observation_message(seen); }));
}

}  // namespace kinecal::detail
