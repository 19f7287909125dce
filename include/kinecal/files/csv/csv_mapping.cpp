// Definitions of csv_mapping.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_mapping.hpp"

#include <utility>

#include "kinecal/files/csv/csv_observation.ipp"
#include "kinecal/files/yaml/config_map.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"

namespace kinecal {

namespace detail {
namespace {

/// `joints:` or `sliding:`
void read_csv_joints(ConfigMap& map, const std::string& key, bool angle, CsvMapping& mapping) {
  auto joints = map.map(key, key);
  if (!joints) return;
  note_csv_unit(*joints, angle);
  const CsvUnit unit = read_csv_unit(*joints, angle);
  auto columns = joints->map("columns", key + ": columns");
  if (!columns)
    joints->error(joints->place(), "columns is missing: {name of a joint: column, ...}");
  if (columns) {
    for (const ConfigEntry& entry : columns->entries()) {
      for (const CsvJoint& known : mapping.joints) {
        if (known.name == entry.key) {
          columns->error(entry.place, "joint '" + entry.key + "' occurs twice");
        }
      }
      mapping.joints.push_back({entry.key, read_csv_sum(*columns, entry.value, entry.place), unit});
    }
  }
  joints->report_unknown();
}

/// `conditions:`
void read_csv_conditions(ConfigMap& file, CsvMapping& mapping) {
  const auto conditions = file.map("conditions", "conditions");
  if (!conditions) return;
  for (const ConfigEntry& entry : conditions->entries()) {
    mapping.conditions.push_back({entry.key, read_csv_sum(*conditions, entry.value, entry.place)});
  }
}

[[nodiscard]] CsvMapping read_csv_mapping(ConfigMap& file, CsvUse use) {
  CsvMapping mapping;
  const std::string separator =
      read_choice(file, "separator", "comma", {"comma", "semicolon", "tab", "space"});
  mapping.separator = separator == "comma" ? ',' : separator == "tab" ? '\t' : ' ';
  if (separator == "semicolon") mapping.separator = ';';
  mapping.header = file.flag("header", true);
  read_csv_joints(file, "joints", true, mapping);
  read_csv_joints(file, "sliding", false, mapping);
  read_csv_conditions(file, mapping);
  for (const ConfigEntry& entry : file.list("observations")) {
    if (auto map = file.map(entry, "observation")) read_csv_observation(*map, mapping);
  }
  if (mapping.joints.empty()) file.error(file.place(), "no joint is given; list them under joints");
  if (use == CsvUse::joints) {
    mapping.observations.clear();
  } else if (mapping.observations.empty()) {
    file.error(file.place(), "no observation is given; list at least one under observations");
  }
  file.report_unknown();
  return mapping;
}

}  // namespace
}  // namespace detail

CsvMapping read_csv_mapping(const std::string& path, Diagnostics& diagnostics, CsvUse use) {
  const detail::YamlNode content = detail::load_config(path, diagnostics);
  if (!content.is_map()) {
    diagnostics.error({path, 0}, detail::describe_wrong_file(content, "a description of columns"));
    return {};
  }
  detail::ConfigMap file(content, {path, 0}, "", diagnostics);
  return detail::read_csv_mapping(file, use);
}

}  // namespace kinecal
