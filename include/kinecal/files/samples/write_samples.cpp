// Definitions of write_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/samples/write_samples.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"

namespace kinecal {
namespace detail {
namespace {

[[nodiscard]] std::string joint_states_to_yaml(const Sample& sample) {
  std::string names;
  for (const std::string& name : sample.joint_names) {
    if (!names.empty()) names += ", ";
    names += name_to_yaml(name);
  }
  std::string header;
  if (sample.stamp) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    header = fmt::format("header: {{stamp: {{secs: {}, nsecs: {}}}}}, ",
                         sample.stamp->count() / kSecond, sample.stamp->count() % kSecond);
  }
  std::string velocities;
  if (!sample.joint_velocities.empty()) {
    velocities = ", velocity: " + numbers_to_yaml(sample.joint_velocities);
  }
  return fmt::format("joint_states: {{{}name: [{}], position: {}{}}}\n", header, names,
                     numbers_to_yaml(sample.joint_positions), velocities);
}

/// Empty for a sample without measured poses.
[[nodiscard]] std::string poses_to_yaml(const Sample& sample) {
  std::string all;
  for (const auto& [joint, pose] : sample.poses) {
    const Eigen::Vector4d q = quaternion(pose.rotation).normalized();
    all += fmt::format("{}{}: {{xyz: {}, quaternion_xyzw: {}}}", all.empty() ? "" : ", ",
                       name_to_yaml(joint), numbers_to_yaml({pose.translation.data(), 3}),
                       numbers_to_yaml({q.data(), 4}));
  }
  return all.empty() ? "" : fmt::format("poses: {{{}}}\n", all);
}

/// "conditions: {temperature: 21.5}"; empty if there are none.
[[nodiscard]] std::string conditions_to_yaml(const std::map<std::string, double>& conditions) {
  std::string all;
  for (const auto& [name, value] : conditions) {
    all +=
        fmt::format("{}{}: {}", all.empty() ? "" : ", ", name_to_yaml(name), number_to_yaml(value));
  }
  return all.empty() ? "" : fmt::format("conditions: {{{}}}", all);
}

[[nodiscard]] std::string feature_to_yaml(const Feature& feature) {
  const auto& p = feature.point;
  std::string others;
  if (feature.rotation) {
    const Eigen::Vector4d q = quaternion(*feature.rotation).normalized();
    others = fmt::format(", orientation: {{x: {}, y: {}, z: {}, w: {}}}", number_to_yaml(q(0)),
                         number_to_yaml(q(1)), number_to_yaml(q(2)), number_to_yaml(q(3)));
  }
  if (feature.sigma) others += fmt::format(", sigma: {}", number_to_yaml(*feature.sigma));
  if (feature.id) others += fmt::format(", id: {}", *feature.id);
  if (!feature.conditions.empty()) others += ", " + conditions_to_yaml(feature.conditions);
  return fmt::format("  - {{header: {{frame_id: {}}}, point: {{x: {}, y: {}, z: {}}}{}}}\n",
                     name_to_yaml(feature.frame), number_to_yaml(p.x()), number_to_yaml(p.y()),
                     number_to_yaml(p.z()), others);
}

[[nodiscard]] std::string camera_to_yaml(const CameraInfo& camera) {
  std::string text = "  ext_camera_info:\n    camera_info: {";
  text += fmt::format("height: {}, width: {}, distortion_model: {}, ", camera.height, camera.width,
                      name_to_yaml(camera.distortion_model));
  text +=
      fmt::format("D: {}, K: {}, R: {}, P: {}}}\n", numbers_to_yaml(camera.d),
                  numbers_to_yaml(camera.k), numbers_to_yaml(camera.r), numbers_to_yaml(camera.p));
  text += fmt::format(
      "    parameters: [{{name: z_offset_mm, value: {}}}, {{name: z_scaling, value: {}}}]\n",
      millimetres_from_metres(camera.z_offset), number_to_yaml(camera.z_scaling));
  return text;
}

[[nodiscard]] std::string observation_to_yaml(const Observation& observation) {
  std::string text =
      fmt::format("- sensor_name: {}\n  features:{}\n", name_to_yaml(observation.sensor),
                  observation.features.empty() ? " []" : "");
  for (const Feature& feature : observation.features) text += feature_to_yaml(feature);
  if (observation.camera) text += camera_to_yaml(*observation.camera);
  return text;
}

}  // namespace
}  // namespace detail

void write_samples(std::ostream& out, const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const std::size_t names = sample.joint_names.size(), positions = sample.joint_positions.size();
    if (names != positions) {
      throw std::invalid_argument(fmt::format(
          "sample {}: {} joint name{} but {} position{}; it cannot be written", sample.source,
          names, names == 1 ? "" : "s", positions, positions == 1 ? "" : "s"));
    }
    out << detail::joint_states_to_yaml(sample) << detail::poses_to_yaml(sample)
        << detail::conditions_to_yaml(sample.conditions) << (sample.conditions.empty() ? "" : "\n")
        << (sample.observations.empty() ? "observations: []\n" : "observations:\n");
    for (const Observation& o : sample.observations) out << detail::observation_to_yaml(o);
    out << "---\n";
  }
}

}  // namespace kinecal
