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

/// Columns named after joints of the URDF: "position.shoulder_pan_joint", "shoulder pan [deg]".
[[nodiscard]] inline ColumnOfJoint joints_by_name(const Robot& robot, const ReadTable& table) {
  const std::set<std::string> others = {
      "velocity", "vel",     "effort",   "torque", "current",      "target", "command",
      "cmd",      "desired", "setpoint", "error",  "acceleration", "acc",    "temperature"};
  const auto is_rest = [&](const std::string& word) {
    return std::set<std::string>{"joint",     "joints", "state",  "states",   "position",
                                 "positions", "pos",    "actual", "measured", "angle",
                                 "q",         "j",      "axis",   "theta"}
        .contains(word);
  };
  ColumnOfJoint all;
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    std::vector<std::string> name = words_of(joint.name);
    std::erase(name, "joint");
    if (name.empty()) continue;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      std::vector<std::string> words = table.columns[c].words;
      if (!table.columns[c].is_number) continue;
      if (std::any_of(words.begin(), words.end(),
                      [&](const auto& word) { return others.contains(word); }))
        continue;
      if (words_of(joint.name) != words) {
        std::erase(words, "joint");
        const auto at = std::search(words.begin(), words.end(), name.begin(), name.end());
        if (at == words.end()) continue;
        words.erase(at, at + static_cast<std::ptrdiff_t>(name.size()));
        if (!std::all_of(words.begin(), words.end(), is_rest)) continue;
      }
      all.emplace_back(joint.name, static_cast<int>(c));
      break;
    }
  }
  return all;
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
  std::map<std::string, std::map<int, int>> numbered;  // name -> number -> column
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    std::vector<std::string> words = table.columns[c].words;
    if (words.size() < 2 || words.back().size() > 2 || !table.columns[c].is_number) continue;
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
