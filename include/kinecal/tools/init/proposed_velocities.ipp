// Which column of a table holds the velocity of which joint: for proposed_columns.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/tools/init/proposed_joints.ipp"

namespace kinecal::detail {

/// Columns such as "shoulder_pan_velocity", "elbow_vel" or "elbow [deg/s]".
[[nodiscard]] inline ColumnOfJoint velocities_by_name(const Robot& robot, const ReadTable& table,
                                                      const ColumnOfJoint& joints) {
  ColumnOfJoint all;
  for (const auto& [joint, position] : joints) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const TableColumn& column = table.columns[c];
      std::vector<std::string> words = column.words;
      const bool says_velocity = std::erase_if(words, is_velocity) > 0 || column.per_second;
      if (!says_velocity || !column.is_complete || static_cast<int>(c) == position) continue;
      if (std::any_of(words.begin(), words.end(), is_other_quantity)) continue;
      if (!names_joint(words, robot.joint(joint))) continue;
      all.emplace_back(joint, static_cast<int>(c));
      break;
    }
  }
  return all;
}

/// Columns dq1 dq2 ..., of one name, where the positions are q1 q2 ... too: in the same order.
[[nodiscard]] inline ColumnOfJoint velocities_by_number(const Robot& robot, const ReadTable& table,
                                                        const ColumnOfJoint& joints) {
  if (!joints_by_name(robot, table).empty()) return {};
  const std::set<std::string> names = {"dq",
                                       "qd",
                                       "actual_qd",
                                       "actual_dq",
                                       "vel",
                                       "velocity",
                                       "joint_velocity",
                                       "joint_vel",
                                       "velocities",
                                       "joint_velocities",
                                       "qvel",
                                       "speed"};
  const auto numbered =
      numbered_columns(table, names, [](const TableColumn& column) { return column.is_complete; });
  if (numbered.size() != 1 || numbered.begin()->second.size() != joints.size()) return {};
  ColumnOfJoint all;
  for (const auto& [number, column] : numbered.begin()->second) {
    all.emplace_back(joints[all.size()].first, column);
  }
  return all;
}

/// The velocities of all joints; empty if one is missing, or not in every row.
/// @param joints  the columns of their positions
[[nodiscard]] inline ColumnOfJoint proposed_velocities(const Robot& robot, const ReadTable& table,
                                                       const ColumnOfJoint& joints) {
  if (!table.header) return {};
  ColumnOfJoint all = velocities_by_name(robot, table, joints);
  if (all.empty()) all = velocities_by_number(robot, table, joints);
  return all.size() == joints.size() ? all : ColumnOfJoint{};
}

}  // namespace kinecal::detail
