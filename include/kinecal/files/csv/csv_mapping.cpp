// Definitions of csv_mapping.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/csv/csv_observation.ipp"
#include "kinecal/files/yaml/config_map.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

/// `joints:`, `sliding:` or the velocities of either
void read_csv_joints(ConfigMap& map, const std::string& key, const CsvUnitNames& units,
                     std::vector<CsvJoint>& all) {
  auto joints = map.map(key, key);
  if (!joints) return;
  note_csv_unit(*joints, units);
  const CsvUnit unit = read_csv_unit(*joints, units);
  auto columns = joints->map("columns", key + ": columns");
  if (!columns)
    joints->error(joints->place(), "columns is missing: {name of a joint: column, ...}");
  if (columns) {
    for (const ConfigEntry& entry : columns->entries()) {
      for (const CsvJoint& known : all) {
        if (known.name == entry.key) {
          columns->error(entry.place, "joint '" + entry.key + "' occurs twice");
        }
      }
      all.push_back({entry.key, read_csv_sum(*columns, entry.value, entry.place), unit});
    }
  }
  joints->report_unknown();
}

/// `poses:`
void read_csv_poses(ConfigMap& file, CsvMapping& mapping) {
  auto poses = file.map("poses", "poses");
  if (!poses) return;
  for (const ConfigEntry& entry : poses->entries()) {
    auto map = poses->map(entry, "pose of '" + entry.key + "'");
    if (!map) continue;
    CsvPose pose{entry.key};
    const std::string name = map->required_text("form").value_or("quaternion_xyzw");
    const auto form = pose_form(name);
    if (!form) {
      map->error(map->place(), fmt::format("form '{}' is none of {}; angles about other axes are "
                                           "fixed_zyx, euler_xyz and so on{}",
                                           name, fmt::join(pose_form_names(), ", "),
                                           map->did_you_mean(name, pose_form_names())));
    }
    pose.form = form.value_or(PoseForm{});
    const std::string unit = read_choice(
        *map, "unit", pose.form.millimetres ? "millimetres" : "metres", {"metres", "millimetres"});
    pose.form.millimetres = unit == "millimetres";
    if (pose.form.has_angles()) {
      const std::string angles = read_choice(
          *map, "angles", pose.form.degrees ? "degrees" : "radians", {"radians", "degrees"});
      pose.form.degrees = angles == "degrees";
    }
    pose.form.inverse = map->flag("inverse", false);
    if (const ConfigEntry* columns = map->find("columns")) {
      pose.columns = read_csv_sum(*map, columns->value, columns->place);
      if (form && !pose.form.has_size(pose.columns.size())) {
        map->error(columns->place,
                   fmt::format("has {}; the form has {}", counted(pose.columns.size(), "column"),
                               pose.form.columns_text()));
      }
    } else {
      map->error(map->place(), "columns is missing: the form has " + pose.form.columns_text());
    }
    map->report_unknown();
    mapping.poses.push_back(std::move(pose));
  }
}

/// `velocities:` and `sliding_velocities:`, in the order of the joints: of all or of none
void read_csv_velocities(ConfigMap& file, CsvMapping& mapping) {
  std::vector<CsvJoint> velocities;
  read_csv_joints(file, "velocities", kAngularSpeeds, velocities);
  read_csv_joints(file, "sliding_velocities", kSpeeds, velocities);
  if (velocities.empty()) return;
  const ConfigEntry* first = file.peek("velocities");
  const SourceLocation place = (first != nullptr ? first : file.peek("sliding_velocities"))->place;
  std::vector<std::string> missing;
  for (const CsvJoint& joint : mapping.joints) {
    const auto found = std::find_if(velocities.begin(), velocities.end(),
                                    [&](const CsvJoint& v) { return v.name == joint.name; });
    if (found == velocities.end()) {
      missing.push_back("'" + joint.name + "'");
      continue;
    }
    mapping.velocities.push_back(std::move(*found));
    velocities.erase(found);
  }
  if (!missing.empty()) {
    file.error(place, fmt::format("velocities: no column for joint{} {}; give all joints or none",
                                  missing.size() == 1 ? "" : "s", fmt::join(missing, ", ")));
  }
  for (const CsvJoint& velocity : velocities) {
    const SourceLocation where = velocity.columns.empty() ? place : velocity.columns.front().place;
    file.error(where, fmt::format("velocities: joint '{}' has no position under joints or sliding",
                                  velocity.name));
  }
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
  read_csv_joints(file, "joints", kAngles, mapping.joints);
  read_csv_joints(file, "sliding", kLengths, mapping.joints);
  read_csv_poses(file, mapping);
  read_csv_velocities(file, mapping);
  read_csv_conditions(file, mapping);
  for (const ConfigEntry& entry : file.list("observations")) {
    if (auto map = file.map(entry, "observation")) read_csv_observation(*map, mapping);
  }
  if (mapping.joints.empty() && mapping.poses.empty()) {
    file.error(file.place(),
               "no joint is given; list them under joints, or measured poses of "
               "floating joints under poses");
  }
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
