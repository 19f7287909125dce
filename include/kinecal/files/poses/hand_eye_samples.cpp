// Definitions of hand_eye_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/poses/hand_eye_samples.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "kinecal/files/poses/hand_eye_names.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

// Reads the poses of a sample that MoveIt Calibration or easy_handeye2 saved.

constexpr const char* kFlangePose = "effector_wrt_world";
constexpr const char* kObjectPose = "object_wrt_sensor";

/// The two poses of a sample.
struct HandEyePair {
  Pose<double> base_T_flange, camera_T_object;
};

/// A finite number; an error and zero for anything else.
[[nodiscard]] double finite_pose_number(const ConfigEntry& entry, const std::string& name,
                                        const ConfigMap& map) {
  const std::optional<double> number = config_number(entry.value);
  if (number && std::isfinite(*number)) return *number;
  map.error(entry.place, name + ": " + describe_config(entry.value) + " is not a finite number");
  return 0.0;
}

/// A pose of numbers without errors; says what is wrong with it.
[[nodiscard]] Pose<double> checked_pose(const PoseForm& form, std::span<const double> numbers,
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
[[nodiscard]] const ConfigEntry* required_pose(ConfigMap& map, const char* key) {
  const ConfigEntry* entry = map.find(key);
  if (entry == nullptr) {
    map.error(map.place(), fmt::format("{} is missing: each sample needs both poses", key));
  }
  return entry;
}

[[nodiscard]] Pose<double> pose_of_16(ConfigMap& map, const char* key) {
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

[[nodiscard]] HandEyePair moveit_pair(ConfigMap& map) {
  return {pose_of_16(map, kFlangePose), pose_of_16(map, kObjectPose)};
}

/// @param inverse  the numbers are those of the inverse
[[nodiscard]] Pose<double> pose_of_transform(ConfigMap& map, const char* key, bool inverse) {
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

/// Whether easy_handeye2's camera is on the hand, by the file or, without it, as the user said.
[[nodiscard]] std::optional<bool> is_camera_on_hand(ConfigMap& file, std::optional<bool> given) {
  std::string type;
  auto parameters = file.map("parameters", "parameters");
  if (parameters && parameters->find("calibration_type") != nullptr) {
    type = parameters->find("calibration_type")->value.text;
  }
  if (type.empty()) {
    if (!given) {
      file.error(file.place(),
                 "calibration_type is empty, so that it is not known where the camera is; "
                 "'kinecal init --poses' asks for it and writes samples");
    }
    return given;
  }
  const bool on_hand = type == "eye_in_hand";
  const SourceLocation place = parameters->find("calibration_type")->place;
  if (!on_hand && type != "eye_on_base") {
    file.error(place, "calibration_type is '" + type + "', not eye_in_hand or eye_on_base");
  } else if (given && *given != on_hand) {
    file.error(place, fmt::format("calibration_type is {}: the camera is {}; give --target {}",
                                  type, on_hand ? "on the hand" : "beside the robot",
                                  on_hand ? "world_marker" : "marker"));
  }
  return on_hand;
}

}  // namespace
}  // namespace detail

Sample hand_eye_sample(const Pose<double>& base_T_flange, const Pose<double>& camera_T_object) {
  using Names = HandEyeNames;
  Sample sample;
  sample.poses[Names::kFlangeJoint] = base_T_flange;
  sample.observations = {
      {Names::kObject, {{Names::kTarget, Vector3<double>::Zero(), Matrix3<double>::Identity()}}},
      {Names::kCamera, {{Names::kCamera, camera_T_object.translation, camera_T_object.rotation}}}};
  return sample;
}

bool is_hand_eye_samples(const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;
  std::array<char, 2048> bytes{};
  std::ifstream file(path);
  file.read(bytes.data(), bytes.size());
  std::string_view text(bytes.data(), static_cast<std::size_t>(file.gcount()));
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  const bool of_moveit = has(detail::kFlangePose) || has(detail::kObjectPose);
  return of_moveit || (has("samples:") && (has("robot:") || has("tracking:")));
}

std::vector<Sample> read_hand_eye_samples(const std::string& path,
                                          std::optional<bool> camera_on_hand,
                                          Diagnostics& diagnostics) {
  using namespace detail;
  std::vector<Sample> samples;
  YamlNode content;
  try {
    content = load_config(path, diagnostics);
  } catch (const InputError& error) {
    diagnostics.errors.emplace_back(error.what());
    return samples;
  }
  const YamlNode* list = &content;
  bool inverse = false;
  const std::size_t errors = diagnostics.errors.size();
  if (content.is_map()) {
    ConfigMap file(content, {path, content.line}, "", diagnostics);
    inverse = !is_camera_on_hand(file, camera_on_hand).value_or(true);
    list = content.find("samples");
    if (diagnostics.errors.size() != errors) return samples;
  }
  if (list == nullptr || !list->is_list() || list->items.empty()) {
    diagnostics.error({path, 0}, fmt::format("no samples: a list of {{{}, {}}} is missing",
                                             kFlangePose, kObjectPose));
    return samples;
  }
  constexpr std::size_t kMostErrors = 20;
  for (const YamlNode& element : list->items) {
    const SourceLocation place{path, element.line};
    if (diagnostics.errors.size() > errors + kMostErrors) {
      diagnostics.error(place, "too many errors; the rest of the file is not read");
      return samples;
    }
    const std::string subject = fmt::format("sample {}", samples.size() + 1);
    ConfigMap map(element, place, subject, diagnostics);
    if (!element.is_map()) map.error(place, "is " + describe_config(element) + ", not a map");
    HandEyePair pair;
    if (element.is_map() && content.is_list()) pair = moveit_pair(map);
    if (element.is_map() && content.is_map()) {
      pair.base_T_flange = pose_of_transform(map, "robot", inverse);
      pair.camera_T_object = pose_of_transform(map, "tracking", false);
    }
    samples.push_back(hand_eye_sample(pair.base_T_flange, pair.camera_T_object));
    samples.back().source = place.str();
  }
  return samples;
}

}  // namespace kinecal
