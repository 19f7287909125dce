// Reads the poses of a sample that MoveIt Calibration or easy_handeye2 saved: for hand_eye_samples.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/poses/hand_eye_names.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/yaml/config_map.ipp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal::detail {

inline constexpr const char* kFlangePose = "effector_wrt_world";
inline constexpr const char* kObjectPose = "object_wrt_sensor";

/// The two poses of a sample.
struct HandEyePair {
  Pose<double> base_T_flange, camera_T_object;
};

[[nodiscard]] inline Sample hand_eye_sample(const HandEyePair& pair, const SourceLocation& place) {
  using Names = HandEyeNames;
  Sample sample;
  sample.source = place.str();
  sample.poses[Names::kFlangeJoint] = pair.base_T_flange;
  const Pose<double>& seen = pair.camera_T_object;
  sample.observations = {
      {Names::kObject, {{Names::kTarget, Vector3<double>::Zero(), Matrix3<double>::Identity()}}},
      {Names::kCamera, {{Names::kCamera, seen.translation, seen.rotation}}}};
  return sample;
}

/// A finite number; an error and zero for anything else.
[[nodiscard]] inline double finite_pose_number(const ConfigEntry& entry, const std::string& name,
                                               const ConfigMap& map) {
  const std::optional<double> number = config_number(entry.value);
  if (number && std::isfinite(*number)) return *number;
  map.error(entry.place, name + ": " + describe_config(entry.value) + " is not a finite number");
  return 0.0;
}

/// A pose of numbers without errors; says what is wrong with it.
[[nodiscard]] inline Pose<double> checked_pose(const PoseForm& form,
                                               std::span<const double> numbers,
                                               const ConfigEntry& entry, const ConfigMap& map) {
  const NumberedPose read = pose_from_numbers(form, numbers);
  const std::string far = far_away_text(form.inverse ? read.pose.inverse().translation  // as read
                                                     : read.pose.translation);
  if (!far.empty()) map.error(entry.place, entry.key + ": " + far + "; write metres");
  if (far.empty() && !read.wrong.empty()) {
    map.error(entry.place, entry.key + ": " + read.wrong);
  }
  return read.pose;
}

/// The entry of a required key; an error and nullptr if it is missing.
[[nodiscard]] inline const ConfigEntry* required_pose(ConfigMap& map, const char* key) {
  const ConfigEntry* entry = map.find(key);
  if (entry == nullptr) {
    map.error(map.place(), fmt::format("{} is missing: each sample needs both poses", key));
  }
  return entry;
}

[[nodiscard]] inline Pose<double> pose_of_16(ConfigMap& map, const char* key) {
  const ConfigEntry* entry = required_pose(map, key);
  if (entry == nullptr) return {};
  const std::size_t errors = map.diagnostics().errors.size();
  std::vector<double> numbers;
  for (const ConfigEntry& element : map.list(key)) {
    numbers.push_back(finite_pose_number(element, key, map));
  }
  if (map.diagnostics().errors.size() != errors) return {};
  if (numbers.size() != 16) {
    map.error(entry->place, fmt::format("{} has {}, not the 16 of a 4 x 4 matrix by rows", key,
                                        counted(numbers.size(), "number")));
    return {};
  }
  return checked_pose(*pose_form("matrix"), numbers, *entry, map);
}

[[nodiscard]] inline HandEyePair moveit_pair(ConfigMap& map) {
  return {pose_of_16(map, kFlangePose), pose_of_16(map, kObjectPose)};
}

/// @param inverse  the numbers are those of the inverse
[[nodiscard]] inline Pose<double> pose_of_transform(ConfigMap& map, const char* key, bool inverse) {
  const ConfigEntry* entry = required_pose(map, key);
  if (entry == nullptr) return {};
  const std::size_t errors = map.diagnostics().errors.size();
  auto pose = map.map(key, fmt::format("{} of a sample", key));
  if (!pose) return {};
  std::vector<double> numbers;
  const auto read = [&](const char* part, std::string_view names) {
    auto of = pose->map(part, fmt::format("{} of {}", part, key));
    if (!of) return pose->error(pose->place(), std::string(part) + " is missing");
    for (const char name : names) {
      const ConfigEntry* number = of->find(std::string(1, name));
      if (number == nullptr) of->error(of->place(), fmt::format("{} is missing", name));
      if (number != nullptr) numbers.push_back(finite_pose_number(*number, number->key, *of));
    }
  };
  read("translation", "xyz");
  read("rotation", "xyzw");
  if (map.diagnostics().errors.size() != errors) return {};
  PoseForm form;
  form.inverse = inverse;
  return checked_pose(form, numbers, *entry, map);
}

}  // namespace kinecal::detail
