// Scalars of a configuration: a number, a count, a flag or a text, or nothing where it is none.
//
// Independent of the program's locale.  A tag of somebody's own, as in `!degrees 90`, changes what
// a scalar means; such a scalar is none of these.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "kinecal/io/yaml/yaml_text.hpp"

namespace kinecal {

/// A plain or quoted scalar without a tag of somebody's own.
[[nodiscard]] inline bool is_config_scalar(const YAML::Node& node) {
  if (!node.IsScalar()) return false;
  const std::string& tag = node.Tag();
  return tag.empty() || tag == "?" || tag == "!" || tag.starts_with("tag:yaml.org,2002:");
}

/// What a node is, for messages: 'abc', a list, a map, empty.
[[nodiscard]] inline std::string describe_config(const YAML::Node& node) {
  if (node.IsSequence()) return "a list";
  if (node.IsMap()) return "a map";
  if (!node.IsScalar()) return "empty";
  constexpr std::size_t kShown = 60;  // somebody may give another file for a configuration
  std::string text = node.Scalar();
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return is_config_scalar(node) ? "'" + text + "'" : "'" + node.Tag() + " " + text + "'";
}

/// A text of at least one letter.
[[nodiscard]] inline std::optional<std::string> config_text(const YAML::Node& node) {
  if (!is_config_scalar(node) || node.Scalar().empty()) return std::nullopt;
  return node.Scalar();
}

/// A number, also .inf and -.inf; .nan is none.
[[nodiscard]] inline std::optional<double> config_number(const YAML::Node& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  const std::optional<double> value = number_from_yaml(node.Scalar());
  return value && !std::isnan(*value) ? value : std::nullopt;
}

/// An integer greater than zero.
[[nodiscard]] inline std::optional<int> config_count(const YAML::Node& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  const std::string& text = node.Scalar();
  int value = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value <= 0) return std::nullopt;
  return value;
}

/// true, false and YAML's other words for them, also quoted, and 1 and 0.
[[nodiscard]] inline std::optional<bool> config_flag(const YAML::Node& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  if (node.Scalar() == "1") return true;
  if (node.Scalar() == "0") return false;
  bool value = false;
  if (!YAML::convert<bool>::decode(node, value)) return std::nullopt;
  return value;
}

}  // namespace kinecal
