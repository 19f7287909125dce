// Numbers, counts, flags and texts from the scalars of a configuration; nullopt for other scalars.
//
// Independent of the locale.  A tag that is not YAML's, as in `!degrees 90`, changes the meaning of
// a scalar, so such a scalar is rejected.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// A plain or quoted scalar without a tag, or with one of YAML's.
[[nodiscard]] inline bool is_config_scalar(const YamlNode& node) {
  const std::string& tag = node.tag;
  return node.is_scalar() && (tag.empty() || tag == "!" || tag.starts_with("tag:yaml.org,2002:"));
}

/// A node's description in messages: 'abc', a list, a map, empty.
[[nodiscard]] inline std::string describe_config(const YamlNode& node) {
  if (node.is_list()) return "a list";
  if (node.is_map()) return "a map";
  if (!node.is_scalar()) return "empty";
  constexpr std::size_t kShown = 60;  // the file may not be a configuration at all
  std::string text = printable(node.text);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return is_config_scalar(node) ? "'" + text + "'" : "'" + node.tag + " " + text + "'";
}

/// Why a file is of another kind: "this is a URDF, not a configuration", "the file is 'abc', not a map".
/// @param wanted  what its content must be
[[nodiscard]] inline std::string describe_wrong_file(const YamlNode& content,
                                                     const std::string& kind,
                                                     const std::string& wanted = "a map") {
  if (content.is_scalar() && content.text.starts_with('<')) return "this is a URDF, not " + kind;
  return "the file is " + describe_config(content) + ", not " + wanted;
}

/// A nonempty text without control characters: texts are names, and are printed.
[[nodiscard]] inline std::optional<std::string> config_text(const YamlNode& node) {
  if (!is_config_scalar(node) || node.text.empty()) return std::nullopt;
  if (has_control_characters(node.text)) return std::nullopt;
  return node.text;
}

/// A number, .inf or -.inf; .nan is not a number.
[[nodiscard]] inline std::optional<double> config_number(const YamlNode& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  const std::optional<double> value = number_from_yaml(node.text);
  return value && !std::isnan(*value) ? value : std::nullopt;
}

/// An integer greater than zero.
[[nodiscard]] inline std::optional<int> config_count(const YamlNode& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  const std::string& text = node.text;
  int value = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value <= 0) return std::nullopt;
  return value;
}

/// true, false and YAML's other words for them in lower, upper or title case, also quoted; 1 and 0.
[[nodiscard]] inline std::optional<bool> config_flag(const YamlNode& node) {
  using Words = std::array<std::string_view, 12>;
  constexpr Words kTrue = {"1",   "true", "True", "TRUE", "yes", "Yes",
                           "YES", "on",   "On",   "ON",   "y",   "Y"};
  constexpr Words kFalse = {"0",  "false", "False", "FALSE", "no", "No",
                            "NO", "off",   "Off",   "OFF",   "n",  "N"};
  if (!is_config_scalar(node)) return std::nullopt;
  const auto is_one_of = [&](const Words& words) {
    return std::find(words.begin(), words.end(), node.text) != words.end();
  };
  if (is_one_of(kTrue)) return true;
  if (is_one_of(kFalse)) return false;
  return std::nullopt;
}

}  // namespace kinecal::detail
