// Definitions of csv_mapping.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/csv_mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/samples/feature_id_parameters.ipp"
#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {

// Reads one sensor of a mapping: columns of its points or pixels, frames, ids.

/// A column, or a list of them.
[[nodiscard]] inline CsvSum read_csv_sum(const ConfigMap& map, const YamlNode& node,
                                         const SourceLocation& place) {
  CsvSum sum;
  const auto add = [&](const YamlNode& column) {
    const auto name = config_text(column);
    if (name) sum.push_back({*name, {place.file, column.line}});
    if (!name) map.error(place, describe_config(column) + " is not a column");
  };
  if (node.is_list()) {
    for (const YamlNode& column : node.items) add(column);
    if (node.items.empty()) map.error(place, "a list of columns is empty");
  } else {
    add(node);
  }
  return sum;
}

/// The two units that a key of columns.yaml may have.
struct CsvUnitNames {
  const char *si, *other;
  CsvUnit meaning;  ///< of the other
};

inline constexpr CsvUnitNames kAngles{"radians", "degrees", {true, false}};
inline constexpr CsvUnitNames kLengths{"metres", "millimetres", {false, true}};
inline constexpr CsvUnitNames kAngularSpeeds{"rad/s", "deg/s", {true, false}};
inline constexpr CsvUnitNames kSpeeds{"m/s", "mm/s", {false, true}};

[[nodiscard]] inline CsvUnit read_csv_unit(ConfigMap& map, const CsvUnitNames& names) {
  const std::string unit = read_choice(map, "unit", names.si, {names.si, names.other});
  return unit == names.other ? names.meaning : CsvUnit{};
}

/// Notes the unit that is taken if none is given: it decides the scale.
inline void note_csv_unit(const ConfigMap& map, const CsvUnitNames& names) {
  if (map.peek("unit") != nullptr) return;
  map.note(map.place(), fmt::format("unit is not given: {}", names.si));
}

/// `form:`, `unit:`, `angles:` and `inverse:` of poses; nullopt after an error
[[nodiscard]] inline std::optional<PoseForm> read_csv_form(ConfigMap& map) {
  const std::string name = map.required_text("form").value_or("quaternion_xyzw");
  std::optional<PoseForm> form = pose_form(name);
  if (!form) {
    map.error(map.place(), fmt::format("form '{}' is none of {}; angles about other axes are "
                                       "fixed_zyx, euler_xyz and so on{}",
                                       name, fmt::join(pose_form_names(), ", "),
                                       map.did_you_mean(name, pose_form_names())));
  }
  PoseForm read = form.value_or(PoseForm{});
  const std::string unit = read_choice(map, "unit", read.millimetres ? "millimetres" : "metres",
                                       {"metres", "millimetres"});
  read.millimetres = unit == "millimetres";
  if (read.has_angles()) {
    const std::string angles =
        read_choice(map, "angles", read.degrees ? "degrees" : "radians", {"radians", "degrees"});
    read.degrees = angles == "degrees";
  }
  read.inverse = map.flag("inverse", false);
  return form ? std::optional(read) : std::nullopt;
}

/// `poses:` and `constant_poses:` of an observation
inline void read_csv_object_poses(ConfigMap& map, CsvObservation& observation) {
  const std::optional<PoseForm> form = read_csv_form(map);
  observation.form = form.value_or(PoseForm{});
  const auto has_size = [&](const ConfigEntry& entry) {
    const std::size_t size = entry.value.is_list() ? entry.value.items.size() : 0;
    if (!form || observation.form.has_size(size)) return form.has_value();
    map.error(entry.place,
              fmt::format("{}: {} is not a list of {}", entry.key, describe_config(entry.value),
                          observation.form.columns_text()));
    return false;
  };
  for (const ConfigEntry& entry : map.list("poses")) {
    if (has_size(entry)) observation.poses.push_back(read_csv_sum(map, entry.value, entry.place));
  }
  for (const ConfigEntry& entry : map.list("constant_poses")) {
    if (!has_size(entry)) continue;
    std::vector<double> numbers;
    for (const YamlNode& node : entry.value.items)
      numbers.push_back(config_number(node).value_or(NAN));
    const NumberedPose read = pose_from_numbers(observation.form, numbers);
    const bool is_finite = read.pose.translation.allFinite() && read.pose.rotation.allFinite();
    if (!read.wrong.empty() || !is_finite) {
      map.error(entry.place,
                "constant_poses: " + (is_finite ? read.wrong : "not all are finite numbers"));
    }
    observation.constant_poses.push_back(read.pose);
  }
}

/// `points:` (three columns each) or `pixels:` (two)
inline void read_csv_points(ConfigMap& map, const std::string& key, std::size_t columns,
                            CsvObservation& observation) {
  for (const ConfigEntry& entry : map.list(key)) {
    if (!entry.value.is_list() || entry.value.items.size() != columns) {
      map.error(entry.place,
                key + ": " + describe_config(entry.value) + " is not a list of " +
                    (columns == 3 ? "three columns, [x, y, z]" : "two columns, [u, v]"));
      continue;
    }
    std::array<CsvSum, 3> point;
    for (std::size_t i = 0; i < columns; ++i) {
      const bool is_zero = config_text(entry.value.items[i]) == "0";  // columns count from 1
      if (!is_zero) point[i] = read_csv_sum(map, entry.value.items[i], entry.place);
    }
    observation.points.push_back(std::move(point));
  }
}

/// `constant: [x, y, z]`, or a list of such points, in the observation's unit
inline void read_csv_constant(ConfigMap& map, CsvObservation& observation) {
  const ConfigEntry* entry = map.find("constant");
  if (entry == nullptr) return;
  const auto add = [&](const YamlNode& node) {
    Vector3<double> point = Vector3<double>::Zero();
    bool good = node.is_list() && node.items.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      const auto number = config_number(node.items[i]);
      good = number && std::isfinite(*number);
      if (good) point(static_cast<Eigen::Index>(i)) = *number;
    }
    if (!good) {
      map.error(entry->place,
                "constant is not a list of three numbers, [x, y, z], nor a list of such lists");
    }
    observation.constants.push_back(observation.unit.millimetres ? point / 1000.0 : point);
  };
  const YamlNode& value = entry->value;
  if (value.is_list() && !value.items.empty() && value.items.front().is_list()) {
    for (const YamlNode& point : value.items) add(point);
  } else {
    add(value);
  }
}

/// `frame:`, `frame_column:` or both
inline void read_csv_frame(ConfigMap& map, CsvObservation& observation) {
  const ConfigEntry* column = map.find("frame_column");
  if (column == nullptr) {
    observation.frame = map.required_text("frame").value_or("");
    return;
  }
  if (map.find("frame") != nullptr) observation.frame = map.required_text("frame").value_or("");
  observation.frame_column = read_csv_sum(map, column->value, column->place);
  if (observation.frame_column.size() > 1) {
    map.error(column->place, "frame_column is a list; one column names the frame");
  }
}

/// `ids:` or `id_columns:`, one for each feature
inline void read_csv_ids(ConfigMap& map, CsvObservation& observation) {
  const std::size_t features = observation.points.size() + observation.constants.size() +
                               observation.poses.size() + observation.constant_poses.size();
  const ConfigEntry *ids = map.find("ids"), *columns = map.find("id_columns");
  if (ids != nullptr && columns != nullptr) {
    map.error(columns->place, "has ids and id_columns; give one of them");
  }
  const auto check = [&](const ConfigEntry& entry, std::size_t count, const char* what) {
    if (count == features) return;
    map.error(entry.place, fmt::format("has {} {}, but {} features; give each of them one", count,
                                       what, features));
  };
  if (columns != nullptr) {
    observation.id_columns = read_csv_sum(map, columns->value, columns->place);
    check(*columns, observation.id_columns.size(), "id_columns");
  } else if (ids != nullptr) {
    const std::vector<YamlNode> one = {ids->value};
    for (const YamlNode& node : ids->value.is_list() ? ids->value.items : one) {
      const auto number = config_number(node);
      const auto id = number ? feature_id(*number) : std::nullopt;
      if (!id)
        map.error(ids->place, "ids: " + describe_config(node) + " is not a whole number from 0");
      observation.ids.push_back(id.value_or(0));
    }
    check(*ids, observation.ids.size(), "ids");
  }
}

/// `separator:` and `header:` of a table.
inline void read_csv_form_of_table(ConfigMap& map, char& separator, bool& header) {
  constexpr std::array<std::pair<const char*, char>, 4> kSeparators{
      {{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"space", ' '}}};
  const auto is_usual = [&](const auto& one) { return one.second == separator; };
  const char* usual = std::find_if(kSeparators.begin(), kSeparators.end(), is_usual)->first;
  const std::string name =
      read_choice(map, "separator", usual, {"comma", "semicolon", "tab", "space"});
  for (const auto& [known, character] : kSeparators) {
    if (name == known) separator = character;
  }
  header = map.flag("header", header);
}

/// `table:`, `match:`, and how the table is read if not as that of the samples
inline void read_csv_own_table(ConfigMap& map, const CsvMapping& mapping,
                               CsvObservation& observation) {
  const ConfigEntry *table = map.find("table"), *match = map.find("match");
  observation.separator = mapping.separator;
  observation.header = mapping.header;
  if (table != nullptr) read_csv_form_of_table(map, observation.separator, observation.header);
  if (match != nullptr) {
    observation.match = read_csv_sum(map, match->value, match->place);
    if (table == nullptr) map.error(match->place, "has match, but no table");
    if (observation.match.size() > 1) map.error(match->place, "match is a list of columns");
  }
  if (table == nullptr) return;
  const auto name = config_text(table->value);
  if (!name) return map.error(table->place, describe_config(table->value) + " is not a file");
  observation.table = (std::filesystem::path(table->place.file).parent_path() / *name).string();
  observation.table_place = table->place;
  if (match != nullptr && observation.has_files()) {
    map.error(match->place, "has match and a table for each sample; give one of them");
  }
  if (!observation.constants.empty() || !observation.constant_poses.empty()) {
    map.error(table->place, "has a table and a constant; give one of them");
  }
}

/// Reports a sensor with points in one entry and pixels in another.
inline void check_csv_kinds(const ConfigMap& map, const CsvMapping& mapping,
                            const CsvObservation& observation) {
  const auto in_pixels = [](const CsvObservation& o) {
    return !o.points.empty() && o.points.front()[2].empty();
  };
  for (const CsvObservation& known : mapping.observations) {
    if (known.sensor != observation.sensor || in_pixels(known) == in_pixels(observation)) continue;
    map.error(map.place(), "has pixels here and points elsewhere; give the sensors two names");
    return;
  }
}

inline void read_csv_observation(ConfigMap& map, CsvMapping& mapping) {
  CsvObservation observation;
  observation.sensor = map.required_text("sensor").value_or("");
  if (!observation.sensor.empty()) map.set_subject("sensor '" + observation.sensor + "'");
  read_csv_frame(map, observation);
  const auto has = [&](const char* key) { return map.peek(key) != nullptr; };
  const bool has_pixels = has("pixels"), has_poses = has("poses") || has("constant_poses");
  if (map.peek("points") != nullptr) note_csv_unit(map, kLengths);
  if (has_poses) read_csv_object_poses(map, observation);
  if (!has_pixels && !has_poses) observation.unit = read_csv_unit(map, kLengths);
  read_csv_constant(map, observation);
  read_csv_points(map, "points", 3, observation);
  read_csv_points(map, "pixels", 2, observation);
  int kinds = 0;
  for (const char* key : {"points", "pixels", "constant", "poses", "constant_poses"})
    kinds += has(key) ? 1 : 0;
  if (kinds != 1) {
    map.error(map.place(),
              "has " + std::string(kinds == 0 ? "none" : "more than one") +
                  " of points, pixels, poses, constant and constant_poses; give exactly one");
  }
  read_csv_ids(map, observation);
  read_csv_own_table(map, mapping, observation);
  check_csv_kinds(map, mapping, observation);
  map.report_unknown();
  mapping.observations.push_back(std::move(observation));
}

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
    std::set<std::string> names;
    for (const CsvJoint& known : all) names.insert(known.name);
    for (const ConfigEntry& entry : columns->entries()) {
      if (!names.insert(entry.key).second) {
        columns->error(entry.place, "joint '" + entry.key + "' occurs twice");
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
    const std::optional<PoseForm> form = read_csv_form(*map);
    pose.form = form.value_or(PoseForm{});
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
  std::map<std::string, CsvJoint*> by_name;
  for (CsvJoint& velocity : velocities) by_name.try_emplace(velocity.name, &velocity);
  std::vector<std::string> missing;
  for (const CsvJoint& joint : mapping.joints) {
    const auto found = by_name.find(joint.name);
    if (found == by_name.end()) {
      missing.push_back("'" + joint.name + "'");
      continue;
    }
    mapping.velocities.push_back(*found->second);
    by_name.erase(found);
  }
  if (!missing.empty()) {
    file.error(place, fmt::format("velocities: no column for joint{} {}; give all joints or none",
                                  missing.size() == 1 ? "" : "s", fmt::join(missing, ", ")));
  }
  for (const auto& [name, velocity] : by_name) {
    const CsvSum& columns = velocity->columns;
    file.error(columns.empty() ? place : columns.front().place,
               fmt::format("velocities: joint '{}' has no position under joints or sliding", name));
  }
}

/// `conditions:` and `increments:`
void read_csv_conditions(ConfigMap& file, const char* key, CsvMapping& mapping) {
  const auto conditions = file.map(key, key);
  if (!conditions) return;
  const bool is_increment = std::string_view(key) == "increments";
  for (const ConfigEntry& entry : conditions->entries()) {
    const auto same = [&](const CsvCondition& other) { return other.name == entry.key; };
    if (std::any_of(mapping.conditions.begin(), mapping.conditions.end(), same)) {
      file.error(entry.place, "'" + entry.key + "' is a condition already");
    }
    CsvCondition& condition = mapping.conditions.emplace_back();
    condition.name = entry.key;
    condition.increment = is_increment;
    if (!entry.value.is_map()) {
      condition.columns = read_csv_sum(*conditions, entry.value, entry.place);
      continue;
    }
    auto map = file.map(entry, key);
    if (!map) continue;
    if (const ConfigEntry* column = map->find("column")) {
      condition.columns = read_csv_sum(*map, column->value, column->place);
    } else {
      map->error(entry.place, "no column is given");
    }
    if (map->peek("unit") != nullptr) {
      const std::string unit = read_choice(*map, "unit", "degrees", {"degrees", "millimetres"});
      condition.unit = {unit == "degrees", unit == "millimetres"};
    }
    map->report_unknown();
  }
}

[[nodiscard]] CsvMapping read_csv_mapping(ConfigMap& file, CsvUse use) {
  CsvMapping mapping;
  read_csv_form_of_table(file, mapping.separator, mapping.header);
  read_csv_joints(file, "joints", kAngles, mapping.joints);
  read_csv_joints(file, "sliding", kLengths, mapping.joints);
  read_csv_poses(file, mapping);
  read_csv_velocities(file, mapping);
  read_csv_conditions(file, "conditions", mapping);
  read_csv_conditions(file, "increments", mapping);
  if (const ConfigEntry* group = file.find("group")) {
    mapping.group = read_csv_sum(file, group->value, group->place);
    if (mapping.group.size() > 1) file.error(group->place, "group is a list of columns");
  }
  for (const ConfigEntry& entry : file.list("observations")) {
    if (auto map = file.map(entry, "observation")) read_csv_observation(*map, mapping);
  }
  if (mapping.joints.empty() && mapping.poses.empty() &&
      (use == CsvUse::joints || mapping.conditions.empty())) {
    file.error(file.place(),
               "no joint is given; list them under joints, or measured poses of "
               "floating joints under poses");
  }
  if (use == CsvUse::joints) {
    mapping.observations.clear();
  } else if (mapping.observations.empty() && mapping.conditions.empty()) {
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
