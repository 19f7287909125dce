// Definitions of config_scalar.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/yaml/config_scalar.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace kinecal::detail {

bool is_config_scalar(const YamlNode& node) {
  const std::string& tag = node.tag;
  return node.is_scalar() && (tag.empty() || tag == "!" || tag.starts_with("tag:yaml.org,2002:"));
}

std::string describe_config(const YamlNode& node) {
  if (node.is_list()) return "a list";
  if (node.is_map()) return "a map";
  if (!node.is_scalar()) return "empty";
  constexpr std::size_t kShown = 60;  // the file may not be a configuration at all
  std::string text = printable(node.text);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return is_config_scalar(node) ? "'" + text + "'" : "'" + node.tag + " " + text + "'";
}

std::string describe_wrong_file(const YamlNode& content, const std::string& kind,
                                const std::string& wanted) {
  if (content.is_scalar() && content.text.starts_with('<')) return "this is a URDF, not " + kind;
  return "the file is " + describe_config(content) + ", not " + wanted;
}

std::optional<std::string> config_text(const YamlNode& node) {
  if (!is_config_scalar(node) || node.text.empty()) return std::nullopt;
  if (has_control_characters(node.text)) return std::nullopt;
  return node.text;
}

std::optional<double> config_number(const YamlNode& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  const std::optional<double> value = number_from_yaml(node.text);
  return value && !std::isnan(*value) ? value : std::nullopt;
}

std::optional<int> config_count(const YamlNode& node) {
  if (!is_config_scalar(node)) return std::nullopt;
  const std::string& text = node.text;
  int value = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value <= 0) return std::nullopt;
  return value;
}

std::optional<bool> config_flag(const YamlNode& node) {
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
