// A sample as the content of a robot_calibration_msgs/CalibrationData message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/io/messages/value.hpp"
#include "kinecal/io/yaml/yaml_text.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {
namespace detail {

/// Fields one after the other: fields("x", 1.0, "y", 2.0).
template <class... Rest>
[[nodiscard]] MessageFields fields(Rest&&... rest) {
  MessageFields result;
  const auto add = [&result]<class Next>(auto& self, std::string_view name, Next&& value,
                                         auto&&... others) -> void {
    result.fields.emplace_back(name, MessageValue(std::forward<Next>(value)));
    if constexpr (sizeof...(others) > 0) self(self, std::forward<decltype(others)>(others)...);
  };
  add(add, std::forward<Rest>(rest)...);
  return result;
}

template <class Range, class F>
[[nodiscard]] MessageValue::List list_of(const Range& range, F&& item) {
  MessageValue::List list;
  list.reserve(std::size(range));
  for (const auto& x : range) list.push_back(MessageValue(item(x)));
  return list;
}

[[nodiscard]] inline MessageValue::List texts(const std::vector<std::string>& all) {
  return list_of(all, [](const std::string& s) { return std::string_view(s); });
}
template <class Range>
[[nodiscard]] MessageValue::List numbers(const Range& all) {
  return list_of(all, [](double x) { return x; });
}

[[nodiscard]] inline MessageFields feature_message(const Feature& feature) {
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

}  // namespace detail

/// @return  views of the sample, which must outlive it
[[nodiscard]] inline MessageFields sample_message(const Sample& sample) {
  using namespace detail;
  return fields(
      "joint_states",
      fields("name", texts(sample.joint_names), "position", numbers(sample.joint_positions)),
      "observations", list_of(sample.observations, [](const Observation& seen) {
        return observation_message(seen);
      }));
}

}  // namespace kinecal
