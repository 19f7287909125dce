// Definitions of proposed_columns.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/proposed_columns.hpp"

#include <map>
#include <set>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/proposed_joints.ipp"
#include "kinecal/tools/init/proposed_points.ipp"
#include "kinecal/tools/init/proposed_velocities.ipp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal {

namespace detail {
namespace {

/// A column as columns.yaml names it: by its number, if its name does not tell it from others.
[[nodiscard]] std::string column_name(const ReadTable& table, int c) {
  const std::string& name = table.columns[static_cast<std::size_t>(c)].name;
  const auto same = [&](const TableColumn& other) { return other.name == name; };
  const auto count = std::count_if(table.columns.begin(), table.columns.end(), same);
  const bool is_clear = table.header && !name.empty() && count == 1;
  return is_clear ? name_to_yaml(name) : fmt::format("{}", c + 1);
}

[[nodiscard]] double largest(const ReadTable& table, const std::vector<int>& columns) {
  double value = 0.0;
  for (const int c : columns)
    value = std::max(value, table.columns[static_cast<std::size_t>(c)].largest);
  return value;
}

/// "unit: degrees  # values up to 148.6"
[[nodiscard]] std::string unit_text(const ReadTable& table, const std::vector<int>& columns,
                                    double limit, NamedUnit small, const char* small_name,
                                    NamedUnit large, const char* large_name) {
  const NamedUnit named = table.columns[static_cast<std::size_t>(columns.front())].unit;
  const double value = largest(table, columns);
  const bool is_large = named == large || (named != small && value > limit);
  return fmt::format("unit: {}{}", is_large ? large_name : small_name,
                     named == small || named == large
                         ? ""
                         : fmt::format("  # by its values, up to {:.4g}", value));
}

[[nodiscard]] std::string joints_text(const Robot& robot, const ReadTable& table,
                                      const ColumnOfJoint& joints, bool turning) {
  std::string text;
  std::vector<int> columns;
  for (const auto& [joint, column] : joints) {
    if (turns(robot.joint(joint).type) != turning) continue;
    columns.push_back(column);
    text += fmt::format("    {}: {}\n", name_to_yaml(joint), column_name(table, column));
  }
  if (columns.empty()) return "";
  constexpr double kMostRadians = 7.0, kMostMetres = 10.0;
  const std::string unit = turning ? unit_text(table, columns, kMostRadians, NamedUnit::radians,
                                               "radians", NamedUnit::degrees, "degrees")
                                   : unit_text(table, columns, kMostMetres, NamedUnit::metres,
                                               "metres", NamedUnit::millimetres, "millimetres");
  return fmt::format("\n{}:\n  {}\n  columns:\n{}", turning ? "joints" : "sliding", unit, text);
}

/// Velocities of the joints that turn or slide.  A unit that the header does not say is that of the
/// positions, per second.
[[nodiscard]] std::string velocities_text(const Robot& robot, const ReadTable& table,
                                          const ColumnOfJoint& velocities, bool turning,
                                          const std::string& joints) {
  std::string text;
  int first = -1;
  for (const auto& [joint, column] : velocities) {
    if (turns(robot.joint(joint).type) != turning) continue;
    if (first < 0) first = column;
    text += fmt::format("    {}: {}\n", name_to_yaml(joint), column_name(table, column));
  }
  if (first < 0) return "";
  const NamedUnit named = table.columns[static_cast<std::size_t>(first)].unit;
  const bool is_known = named != NamedUnit::none;
  const NamedUnit other = turning ? NamedUnit::degrees : NamedUnit::millimetres;
  const bool is_other =
      is_known ? named == other
               : joints.find(turning ? "unit: degrees" : "unit: millimetres") != std::string::npos;
  const char* unit = turning ? (is_other ? "deg/s" : "rad/s") : (is_other ? "mm/s" : "m/s");
  return fmt::format("\n{}:\n  unit: {}{}\n  columns:\n{}",
                     turning ? "velocities" : "sliding_velocities", unit,
                     is_known ? "" : "  # like the positions; the header does not say", text);
}

[[nodiscard]] std::string observations_text(const Robot& robot, const ReadTable& table,
                                            const std::vector<PointColumns>& points) {
  std::string held, measured;
  std::vector<int> columns;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string number = points.size() > 1 ? fmt::format("_{}", i + 1) : "";
    held += fmt::format(
        " - sensor: arm  # the same point of a frame on the arm in every row\n   frame: {}\n"
        "   constant: [0, 0, 0]\n",
        propose_frame(robot, {"smr" + number, "reflector" + number}));
    std::string sums;
    for (std::size_t k = 0; k < 3; ++k) {
      columns.push_back(points[i].xyz[k]);
      const std::string name = column_name(table, points[i].xyz[k]);
      const int deviation = points[i].deviation[k];
      sums += (k > 0 ? ", " : "") +
              (deviation < 0 ? name : fmt::format("[{}, {}]", name, column_name(table, deviation)));
    }
    measured +=
        fmt::format("    - [{}]{}\n", sums,
                    points[i].deviation[0] < 0 ? "" : "  # a point and its deviation: their sum");
  }
  constexpr double kMostMetres = 20.0;
  return fmt::format("\nobservations:\n{} - sensor: tracker\n   frame: {}\n   {}\n   points:\n{}",
                     held, propose_frame(robot, {"tracker_frame", "laser_frame"}),
                     unit_text(table, columns, kMostMetres, NamedUnit::metres, "metres",
                               NamedUnit::millimetres, "millimetres"),
                     measured);
}

}  // namespace
}  // namespace detail

std::string proposed_columns(const Robot& robot, std::string_view text, const std::string& file) {
  using namespace detail;
  const ReadTable table = read_table(text, file);
  const ColumnOfJoint joints = proposed_joints(robot, table, file);
  std::set<int> taken;
  for (const auto& [joint, column] : joints) taken.insert(column);
  const ColumnOfJoint velocities = proposed_velocities(robot, table, joints);
  for (const auto& [joint, column] : velocities) taken.insert(column);
  const std::vector<PointColumns> points =
      table.header ? measured_points(table, taken, file) : std::vector{last_three(table)};
  for (const PointColumns& point : points) {
    taken.insert(point.xyz.begin(), point.xyz.end());
    taken.insert(point.deviation.begin(), point.deviation.end());
  }
  std::string unused;
  for (int c = 0; c < static_cast<int>(table.columns.size()); ++c) {
    if (!taken.contains(c)) unused += (unused.empty() ? "" : ", ") + column_name(table, c);
  }
  const std::map<char, const char*> separators = {
      {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "space"}};
  const std::string turning = joints_text(robot, table, joints, true),
                    sliding = joints_text(robot, table, joints, false);
  return fmt::format(
             "{} by the table's {}: check it.\n"
             "separator: {}\nheader: {}\n",
             kProposedColumnsMark,
             table.header ? "header and values" : "number of columns and values",
             separators.at(table.separator), table.header) +
         turning + sliding + velocities_text(robot, table, velocities, true, turning) +
         velocities_text(robot, table, velocities, false, sliding) +
         observations_text(robot, table, points) +
         (unused.empty() ? "" : "\n# Not used: " + unused + "\n");
}

}  // namespace kinecal
