// Which column of a table holds which joint: for proposed_columns.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "kinecal/tools/init/table_columns.ipp"
#include "kinecal/tools/init/whole_arm.ipp"

namespace kinecal::detail {

/// Whether words are the name of a joint, with or without words such as "position".
[[nodiscard]] inline bool names_joint(std::vector<std::string> words, const Joint& joint) {
  if (words_of(joint.name) == words) return true;
  const auto is_rest = [](const std::string& word) {
    return std::set<std::string>{"joint",     "joints", "state",  "states",   "position",
                                 "positions", "pos",    "actual", "measured", "angle",
                                 "q",         "j",      "axis",   "theta"}
        .contains(word);
  };
  std::vector<std::string> name = words_of(joint.name);
  std::erase(name, "joint");
  if (name.empty()) return false;
  std::erase(words, "joint");
  const auto at = std::search(words.begin(), words.end(), name.begin(), name.end());
  if (at == words.end()) return false;
  words.erase(at, at + static_cast<std::ptrdiff_t>(name.size()));
  return std::all_of(words.begin(), words.end(), is_rest);
}

/// Words of columns that are neither positions nor measured velocities.
[[nodiscard]] inline bool is_other_quantity(const std::string& word) {
  return std::set<std::string>{"effort",  "torque",       "current", "target",
                               "command", "cmd",          "desired", "setpoint",
                               "error",   "acceleration", "acc",     "temperature"}
      .contains(word);
}

[[nodiscard]] inline bool is_velocity(const std::string& word) {
  return std::set<std::string>{"velocity", "velocities", "vel", "speed", "dq", "qd", "qvel"}
      .contains(word);
}

/// Columns named after joints of the URDF: "position.shoulder_pan_joint", "shoulder pan [deg]".
[[nodiscard]] inline ColumnOfJoint joints_by_name(const Robot& robot, const ReadTable& table) {
  ColumnOfJoint all;
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const TableColumn& column = table.columns[c];
      if (!column.is_number || column.per_second) continue;
      const auto is_other = [](const std::string& word) {
        return is_other_quantity(word) || is_velocity(word);
      };
      if (std::any_of(column.words.begin(), column.words.end(), is_other)) continue;
      if (!names_joint(column.words, joint)) continue;
      all.emplace_back(joint.name, static_cast<int>(c));
      break;
    }
  }
  return all;
}

/// Columns of one of the names and a number, numbered from 0 or 1: name -> number -> column.
/// @param is_usable  whether a column may be one of them
[[nodiscard]] inline std::map<std::string, std::map<int, int>> numbered_columns(
    const ReadTable& table, const std::set<std::string>& names,
    bool (*is_usable)(const TableColumn&)) {
  std::map<std::string, std::map<int, int>> numbered;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    std::vector<std::string> words = table.columns[c].words;
    if (words.size() < 2 || words.back().size() > 2 || !is_usable(table.columns[c])) continue;
    const auto number = csv_number(words.back());
    words.pop_back();
    const std::string name = fmt::format("{}", fmt::join(words, "_"));
    if (number && names.contains(name))
      numbered[name][static_cast<int>(*number)] = static_cast<int>(c);
  }
  std::erase_if(numbered, [](const auto& of) {  // 0 1 2 ... or 1 2 3 ...
    const auto& [first, last] = std::pair(of.second.begin()->first, of.second.rbegin()->first);
    return first > 1 || last - first + 1 != static_cast<int>(of.second.size());
  });
  return numbered;
}

/// Columns q1 q2 ..., of one name: in the order of the arm's joints.
[[nodiscard]] inline ColumnOfJoint joints_by_number(const Robot& robot, const ReadTable& table,
                                                    const std::string& file) {
  const std::set<std::string> names = {"q",
                                       "j",
                                       "joint",
                                       "axis",
                                       "a",
                                       "theta",
                                       "th",
                                       "actual_q",
                                       "pos",
                                       "position",
                                       "joint_position",
                                       "joint_pos",
                                       "joint_angle",
                                       "positions",
                                       "joint_positions",
                                       "qpos",
                                       "angle",
                                       "ax"};
  const auto numbered = numbered_columns(table, names, [](const TableColumn& column) {
    return column.is_number && !column.per_second;
  });
  if (numbered.size() > 1) {
    throw InputError(
        fmt::format("{}: both '{}' and '{}' may be joints; say in columns.yaml which are: MANUAL, "
                    "Samples from a table",
                    file, numbered.begin()->first, numbered.rbegin()->first));
  }
  std::vector<int> columns;
  if (!numbered.empty()) {
    for (const auto& [number, column] : numbered.begin()->second) columns.push_back(column);
  }
  if (columns.empty()) return {};
  std::vector<std::vector<std::string>> fitting;
  for (const std::string& arm : propose_arms(robot)) {
    std::vector<std::string> joints = driven_joints(robot, arm);
    if (joints.size() == columns.size() &&
        std::find(fitting.begin(), fitting.end(), joints) == fitting.end()) {
      fitting.push_back(std::move(joints));
    }
  }
  if (fitting.size() != 1) {
    throw InputError(
        fmt::format("{}: has {} columns {}1 ..., and {} of the URDF has as many joints; say in "
                    "columns.yaml which "
                    "joint each column holds: MANUAL, Samples from a table",
                    file, columns.size(), numbered.begin()->first,
                    fitting.empty() ? "no arm" : "more than one arm"));
  }
  ColumnOfJoint all;
  for (std::size_t i = 0; i < columns.size(); ++i) all.emplace_back(fitting.front()[i], columns[i]);
  return all;
}

/// A table without a header: the joints of the only arm, then x, y, z.
[[nodiscard]] inline ColumnOfJoint joints_by_count(const Robot& robot, const ReadTable& table,
                                                   const std::string& file) {
  std::set<std::vector<std::string>> fitting;
  for (const std::string& arm : propose_arms(robot)) {
    const std::vector<std::string> joints = driven_joints(robot, arm);
    if (joints.size() + 3 == table.columns.size()) fitting.insert(joints);
  }
  if (fitting.size() != 1) {
    throw InputError(fmt::format(
        "{}: its first row has no names, and its {} columns are not the joints of {} arm and x, y, "
        "z; "
        "give it a header, or say in columns.yaml what the columns mean: MANUAL, Samples from a "
        "table",
        file, table.columns.size(), fitting.empty() ? "an" : "only one"));
  }
  ColumnOfJoint all;
  for (const std::string& joint : *fitting.begin()) {
    const int column = static_cast<int>(all.size());
    all.emplace_back(joint, column);
  }
  return all;
}

/// @throws InputError  if columns do not tell the joints
[[nodiscard]] inline ColumnOfJoint proposed_joints(const Robot& robot, const ReadTable& table,
                                                   const std::string& file) {
  if (!table.header) return joints_by_count(robot, table, file);
  ColumnOfJoint joints = joints_by_name(robot, table);
  if (!joints.empty()) check_whole_arm(robot, joints, file);
  if (joints.empty()) joints = joints_by_number(robot, table, file);
  if (joints.empty()) {
    std::string driven;
    for (const Joint& joint : robot.joints()) {
      if (moves(joint.type) && !joint.mimic) driven += (driven.empty() ? "" : ", ") + joint.name;
    }
    throw InputError(
        fmt::format("{}: no column has the name of a joint ({}), nor are there q1, q2, ... of an "
                    "arm; say in columns.yaml "
                    "what its columns mean: MANUAL, Samples from a table",
                    file, driven));
  }
  return joints;
}

}  // namespace kinecal::detail
