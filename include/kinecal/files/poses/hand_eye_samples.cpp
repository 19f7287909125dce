// Definitions of hand_eye_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/poses/hand_eye_samples.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "kinecal/files/poses/hand_eye_pair.ipp"
#include "kinecal/files/yaml/config_map.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"

namespace kinecal {
namespace detail {
namespace {

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
    samples.push_back(hand_eye_sample(pair, place));
  }
  return samples;
}

}  // namespace kinecal
