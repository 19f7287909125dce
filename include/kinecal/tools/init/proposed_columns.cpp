// Definitions of proposed_columns.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/proposed_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal {

namespace detail {
namespace {

// The joints of an arm, all of which a table must have.

/// Joints with their columns, by index.
using ColumnOfJoint = std::vector<std::pair<std::string, int>>;

/// The driven joints on the way to a link, from the base on.
[[nodiscard]] std::vector<std::string> driven_joints(const Robot& robot, const std::string& link) {
  std::vector<std::string> names;
  for (const Joint* joint : joints_to_root(robot, link)) {
    if (moves(joint->type) && !joint->mimic) names.insert(names.begin(), joint->name);
  }
  return names;
}

/// Checks that a joint between others of the same arm is not missing: its column has another name.
/// @throws InputError  naming it
void check_whole_arm(const Robot& robot, const ColumnOfJoint& found, const std::string& file) {
  const auto is_found = [&](const std::string& joint) {
    return std::any_of(found.begin(), found.end(),
                       [&](const auto& of) { return of.first == joint; });
  };
  for (const std::string& arm : propose_arms(robot)) {
    const std::vector<std::string> joints = driven_joints(robot, arm);
    const auto here = std::count_if(joints.begin(), joints.end(), is_found);
    if (2 * here < std::ssize(joints)) continue;  // another arm
    const auto missing = std::find_if_not(joints.begin(), joints.end(), is_found);
    if (missing == joints.end()) continue;
    throw InputError(
        fmt::format("{}: {} of the {} joints that move '{}' have a column, and '{}' has none; name "
                    "its column like the joint, or say in "
                    "columns.yaml what the columns mean: MANUAL, Samples from a table",
                    file, here, joints.size(), arm, *missing));
  }
}

// Which column of a table holds which joint.

/// Whether words are the name of a joint, with or without words such as "position".
[[nodiscard]] bool names_joint(std::vector<std::string> words, const Joint& joint) {
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
[[nodiscard]] bool is_other_quantity(const std::string& word) {
  return std::set<std::string>{"effort",  "torque",       "current", "target",
                               "command", "cmd",          "desired", "setpoint",
                               "error",   "acceleration", "acc",     "temperature"}
      .contains(word);
}

[[nodiscard]] bool is_velocity(const std::string& word) {
  return std::set<std::string>{"velocity", "velocities", "vel", "speed", "dq", "qd", "qvel"}
      .contains(word);
}

/// Columns named after joints of the URDF: "position.shoulder_pan_joint", "shoulder pan [deg]".
[[nodiscard]] ColumnOfJoint joints_by_name(const Robot& robot, const ReadTable& table) {
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
[[nodiscard]] std::map<std::string, std::map<int, int>> numbered_columns(
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
[[nodiscard]] ColumnOfJoint joints_by_number(const Robot& robot, const ReadTable& table,
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

/// A table without a header: the joints of the only arm, then so many further columns.
/// @param further  3: x, y, z
[[nodiscard]] ColumnOfJoint joints_by_count(const Robot& robot, const ReadTable& table,
                                            const std::string& file, std::size_t further) {
  std::set<std::vector<std::string>> fitting;
  for (const std::string& arm : propose_arms(robot)) {
    const std::vector<std::string> joints = driven_joints(robot, arm);
    if (joints.size() + further == table.columns.size()) fitting.insert(joints);
  }
  if (fitting.size() != 1) {
    throw InputError(fmt::format(
        "{}: its first row has no names, and its {} columns are not the joints of {} arm{}; "
        "give it a header, or say in columns.yaml what the columns mean: MANUAL, Samples from a "
        "table",
        file, table.columns.size(), fitting.empty() ? "an" : "only one",
        further == 3 ? " and x, y, z" : ""));
  }
  ColumnOfJoint all;
  for (const std::string& joint : *fitting.begin()) {
    const int column = static_cast<int>(all.size());
    all.emplace_back(joint, column);
  }
  return all;
}

/// @throws InputError  if columns do not tell the joints
/// @param touched  by a tip: no further columns without names
[[nodiscard]] ColumnOfJoint proposed_joints(const Robot& robot, const ReadTable& table,
                                            const std::string& file, bool touched) {
  if (!table.header) return joints_by_count(robot, table, file, touched ? 0 : 3);
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
                    "what its columns mean: MANUAL, Samples from a table; {}",
                    file, driven, table.header_text));
  }
  return joints;
}

// Which columns of a table are a measured point.

/// Three columns that are a point: indices of x, y and z.
struct PointColumns {
  std::string rest;  ///< of their names
  std::array<int, 3> xyz = {-1, -1, -1};
  std::array<int, 3> deviation = {-1, -1, -1};  ///< to add
};

[[nodiscard]] bool has_word(const TableColumn& column, const std::set<std::string>& words) {
  return std::any_of(column.words.begin(), column.words.end(),
                     [&](const std::string& word) { return words.contains(word); });
}

/// Complete triples of columns x, y, z that are not taken, in their order; not those of rotations.
[[nodiscard]] std::vector<PointColumns> triples(const ReadTable& table,
                                                const std::set<int>& taken) {
  std::vector<PointColumns> all;
  for (int c = 0; c < static_cast<int>(table.columns.size()); ++c) {
    const TableColumn& column = table.columns[static_cast<std::size_t>(c)];
    if (taken.contains(c) || !column.is_number) continue;
    std::vector<std::string> words = column.words;
    const auto axis = std::find_if(words.rbegin(), words.rend(), [](const std::string& word) {
      return !word.empty() && word.find_first_not_of("0123456789") == 0 &&
             std::string_view("xyz").find(word.back()) != std::string_view::npos &&
             (word.size() == 1 || word.size() == 2);
    });
    if (axis == words.rend()) continue;
    const auto which = std::string_view("xyz").find(axis->back());
    axis->pop_back();  // "dx" is the x of d
    const std::string rest = fmt::format("{}", fmt::join(words, " "));
    auto triple = std::find_if(all.begin(), all.end(),
                               [&](const PointColumns& known) { return known.rest == rest; });
    if (triple == all.end()) triple = all.insert(all.end(), {rest});
    triple->xyz[which] = c;
  }
  const auto is_force = [](const PointColumns& triple) { return triple.rest == "f"; };
  const bool has_forces = std::any_of(all.begin(), all.end(), is_force);
  std::erase_if(all, [&](const PointColumns& triple) {
    const bool whole =
        std::all_of(triple.xyz.begin(), triple.xyz.end(), [](int c) { return c >= 0; });
    const std::vector<std::string> words = words_of(triple.rest);
    if (triple.rest == "t" && has_forces) return true;  // torques; else the translations of Vicon
    return !whole || std::any_of(words.begin(), words.end(), [](const std::string& word) {
      return std::set<std::string>{"r", "rot", "q",        "w",     "quat",   "orientation", "n",
                                   "v", "f",   "velocity", "force", "torque", "accel"}
          .contains(word);
    });
  });
  return all;
}

/// The measured points of a row; deviations are added to them.
/// @throws InputError  if columns do not tell them
[[nodiscard]] std::vector<PointColumns> measured_points(const ReadTable& table,
                                                        const std::set<int>& taken,
                                                        const std::string& file) {
  const std::set<std::string> deviations = {"d",   "dif",       "diff", "delta",
                                            "dev", "deviation", "err",  "error"},
                              computed = {"tcp",       "tool",    "flange",  "fk",  "ee",
                                          "base",      "robot",   "nominal", "cmd", "command",
                                          "commanded", "desired", "actual"};
  std::vector<PointColumns> points = triples(table, taken), added;
  const auto is = [&](const PointColumns& point, const std::set<std::string>& words) {
    return has_word({.name = "", .words = words_of(point.rest)}, words);
  };
  for (const PointColumns& point : points) {
    if (is(point, deviations)) added.push_back(point);
  }
  std::erase_if(points, [&](const PointColumns& point) { return is(point, deviations); });
  if (points.size() > 1) {
    std::erase_if(points, [&](const PointColumns& point) { return is(point, computed); });
  }
  if (points.empty()) {
    throw InputError(
        file +
        ": no three columns are called x, y, z (of a tracker's point); say in columns.yaml "
        "what its columns mean: MANUAL, Samples from a table; " +
        table.header_text);
  }
  // Several: numbered points of one name.
  const auto name = [](const PointColumns& point) {
    std::vector<std::string> words = words_of(point.rest);
    std::erase_if(words, [](const std::string& word) {
      return word.find_first_not_of("0123456789") == std::string::npos;
    });
    return fmt::format("{}", fmt::join(words, " "));
  };
  for (const PointColumns& point : points) {
    if (name(point) == name(points.front())) continue;
    const auto of = [&](const PointColumns& p) {
      return table.columns[static_cast<std::size_t>(p.xyz[0])].name;
    };
    throw InputError(fmt::format(
        "{}: both '{}' and '{}' may begin the point that was measured; say in "
        "columns.yaml which it "
        "is, not what the controller computed from the joints: MANUAL, Samples from a table; {}",
        file, of(points.front()), of(point), table.header_text));
  }
  if (points.size() == 1 && added.size() == 1) points.front().deviation = added.front().xyz;
  return points;
}

/// The same of a table without a header: the three columns after the joints.
[[nodiscard]] PointColumns last_three(const ReadTable& table) {
  const int n = static_cast<int>(table.columns.size());
  return {"", {n - 3, n - 2, n - 1}};
}

// Which column of a table holds the velocity of which joint.

/// Columns such as "shoulder_pan_velocity", "elbow_vel" or "elbow [deg/s]".
[[nodiscard]] ColumnOfJoint velocities_by_name(const Robot& robot, const ReadTable& table,
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
[[nodiscard]] ColumnOfJoint velocities_by_number(const Robot& robot, const ReadTable& table,
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
[[nodiscard]] ColumnOfJoint proposed_velocities(const Robot& robot, const ReadTable& table,
                                                const ColumnOfJoint& joints) {
  if (!table.header) return {};
  ColumnOfJoint all = velocities_by_name(robot, table, joints);
  if (all.empty()) all = velocities_by_number(robot, table, joints);
  return all.size() == joints.size() ? all : ColumnOfJoint{};
}

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

// Tables of a tip that touches something: joints, and which socket.

/// The line of a columns.yaml that says for which target it is.
constexpr const char* kTargetMark = "# Target: ";

/// The sockets that a column names, each once.
[[nodiscard]] std::set<std::string> sockets_in(const ReadTable& table, int column) {
  const std::vector<std::string>& texts = table.columns[static_cast<std::size_t>(column)].texts;
  return {texts.begin(), texts.end()};
}

/// The column that names the socket of each row, each of several rows; -1 if there is none.  One that counts rows is none.
[[nodiscard]] int socket_column(const ReadTable& table) {
  const std::set<std::string> names = {"socket", "sockets", "place", "hole", "nest",    "seat",
                                       "cone",   "station", "point", "ball", "fixture", "marker"};
  for (int c = 0; c < static_cast<int>(table.columns.size()) && table.header; ++c) {
    const std::vector<std::string>& words = table.columns[static_cast<std::size_t>(c)].words;
    if (words.empty() || !names.contains(words.front())) continue;
    const std::size_t rows = table.columns[static_cast<std::size_t>(c)].texts.size();
    if (2 * sockets_in(table, c).size() <= rows) return c;
  }
  return -1;
}

/// The three columns of an accelerometer.
/// @throws InputError  if there is not one
[[nodiscard]] std::array<int, 3> accelerometer_columns(const ReadTable& table,
                                                       const std::string& file) {
  const std::set<std::string> names = {"a",   "acc",    "accel", "accelerometer", "acceleration",
                                       "imu", "gravity"};  // gx is a gyroscope's
  std::array<int, 3> found = {-1, -1, -1};
  for (int c = 0; c < static_cast<int>(table.columns.size()) && table.header; ++c) {
    std::vector<std::string> words = table.columns[static_cast<std::size_t>(c)].words;
    std::erase_if(words, [](const std::string& word) {  // m/s^2
      return word == "m" || word == "s" || word == "2" || word == "linear";
    });
    if (words.empty()) continue;
    std::string last = words.back();
    words.pop_back();
    const std::size_t axis = std::string_view("xyz").find(last.back());
    last.pop_back();
    if (axis == std::string_view::npos || words.size() > 2) continue;
    if (!last.empty()) words.push_back(last);
    const bool is_named =
        !words.empty() && std::all_of(words.begin(), words.end(),
                                      [&](const std::string& w) { return names.contains(w); });
    if (is_named && found[axis] < 0) found[axis] = c;
  }
  if (std::all_of(found.begin(), found.end(), [](int c) { return c >= 0; })) return found;
  throw InputError(fmt::format("{}: no three columns are called ax, ay, az (or acc_x ...); {}",
                               file, table.header_text));
}

/// The column of a distance sensor or dial gauge; -1 if there is none.
[[nodiscard]] int distance_column(const ReadTable& table) {
  const std::set<std::string> names = {"distance", "dist",    "gauge", "dial",
                                       "range",    "reading", "height"};
  for (int c = 0; c < static_cast<int>(table.columns.size()) && table.header; ++c) {
    const TableColumn& column = table.columns[static_cast<std::size_t>(c)];
    if (column.is_number && has_word(column, names)) return c;
  }
  return -1;
}

/// What the tip touches, by the columns if it is not given; nullopt: nothing, there are measured points.
/// @throws InputError  if the table has joints only
[[nodiscard]] std::optional<InitTarget> touched_target(const ReadTable& table,
                                                       std::optional<InitTarget> given,
                                                       const std::string& file) {
  if (given) return is_touched(*given) ? given : std::nullopt;
  if (!table.header || !triples(table, {}).empty()) return std::nullopt;
  if (socket_column(table) >= 0) return InitTarget::sockets;
  std::string words;
  for (const InitTargetWord& word : kInitTargets) {
    if (is_touched(word.target)) words += (words.empty() ? "" : ", ") + std::string(word.word);
  }
  throw InputError(fmt::format(
      "{}: no three columns are called x, y, z (of a tracker's point).  If the table has "
      "joints alone, say what the tip touched in each row: --target with one of {}; of "
      "several sockets, a column 'socket' names the one of each row; {}",
      file, words, table.header_text));
}

/// @throws InputError  if sockets have no names
[[nodiscard]] std::string touched_text(const Robot& robot, const ReadTable& table,
                                       InitTarget target, const std::string& file,
                                       const std::string& sockets_file,
                                       const std::string& tip_frame) {
  InitAnswers answers;
  answers.target = target;
  answers.target_frame = tip_frame;
  if (!sockets_file.empty()) answers.layout = {Vector3<double>::Zero()};
  answers = with_proposals(robot, answers);
  if (target == InitTarget::gravity) {
    const std::array<int, 3> read = accelerometer_columns(table, file);
    return fmt::format(
        "\nconditions:  # what the accelerometer reads, m/s^2\n  ax: {}\n  ay: {}\n  az: {}\n"
        "\nobservations:\n - sensor: {}  # its axes\n   frame: {}\n   form: quaternion\n"
        "   constant_poses: [[0, 0, 0, 0, 0, 0, 1]]\n",
        column_name(table, read[0]), column_name(table, read[1]), column_name(table, read[2]),
        holder_of(answers), answers.target_frame);
  }
  const bool is_grip = target == InitTarget::grip;
  const bool is_pose = is_grip || target == InitTarget::plane || target == InitTarget::line ||
                       target == InitTarget::distance;
  constexpr const char* kPose =
      "   form: quaternion\n   constant_poses: [[0, 0, 0, 0, 0, 0, 1]]  # ";
  std::string tip = is_grip ? std::string(kPose) + "the link itself\n" : "   constant: [0, 0, 0]\n";
  if (target == InitTarget::distance) {
    const int column = distance_column(table);
    if (column < 0) {
      throw InputError(fmt::format("{}: no column is called 'distance', 'gauge' or 'dial'; {}",
                                   file, table.header_text));
    }
    constexpr double kMostMetres = 2.0;
    tip = fmt::format("   {}\n   points: [[0, 0, {}]]\n",
                      unit_text(table, {column}, kMostMetres, NamedUnit::metres, "metres",
                                NamedUnit::millimetres, "millimetres"),
                      column_name(table, column));
  }
  std::string touched = "   frame: " + answers.places.front() + "\n";
  if (is_pose) {
    touched += fmt::format("{}{}\n", kPose,
                           is_grip                      ? "where the other hand has it"
                           : target == InitTarget::line ? "the z axis"
                                                        : "the plane z = 0");
  } else if (target != InitTarget::sockets) {
    touched += "   constant: [0, 0, 0]\n";
  } else {
    const int column = socket_column(table);
    if (column < 0) {
      throw InputError(
          fmt::format("{}: no column says which socket the tip was in; call it 'socket'; {}", file,
                      table.header_text));
    }
    const std::string name = column_name(table, column);
    touched = sockets_file.empty()
                  ? fmt::format(
                        "   frame: socket  # and the cell: socket_{}\n   frame_column: {}\n"
                        "   constant: [0, 0, 0]\n",
                        *sockets_in(table, column).begin(), name)
                  : fmt::format(
                        "   frame: {}\n   unit: metres\n   table: {}  # where the sockets are\n   "
                        "match: {}\n"
                        "   points: [[x, y, z]]\n",
                        answers.places.front(), name_to_yaml(sockets_file), name);
  }
  return fmt::format(
      "\nobservations:\n - sensor: {}  # {}, which is there in every row\n   frame: {}\n"
      "{} - sensor: {}  # {}\n{}",
      holder_of(answers), is_grip ? "one hand" : "the tip", answers.target_frame, tip,
      tracker_of(answers), is_grip ? "the other hand" : "what it touches", touched);
}

}  // namespace
}  // namespace detail

std::optional<InitTarget> target_of_columns(std::string_view text) {
  const std::size_t at = text.find(detail::kTargetMark);
  if (!text.starts_with(kProposedColumnsMark) || at == std::string_view::npos) return std::nullopt;
  const std::string_view rest = text.substr(at + std::string_view(detail::kTargetMark).size());
  const auto known = init_target(rest.substr(0, rest.find('\n')));
  return known ? std::optional(known->target) : std::nullopt;
}

std::string sockets_at_distance(std::string_view text, const std::string& file, double length) {
  using namespace detail;
  const ReadTable table = read_table(text, file);
  const int column = socket_column(table);
  if (column < 0) {
    throw InputError(file +
                     ": --length is the distance of two sockets, and no column is called "
                     "'socket'");
  }
  const std::set<std::string> sockets = sockets_in(table, column);
  if (sockets.size() != 2) {
    throw InputError(
        fmt::format("{}: --length is the distance of two sockets, and column '{}' names {}; write "
                    "the places of "
                    "more into sockets.csv beside the configuration: {}, x, y, z in metres",
                    file, table.columns[static_cast<std::size_t>(column)].name, sockets.size(),
                    table.columns[static_cast<std::size_t>(column)].name));
  }
  return fmt::format("{},x,y,z\n{},0,0,0\n{},{},0,0\n", column_name(table, column),
                     *sockets.begin(), *std::next(sockets.begin()), length);
}

std::string proposed_columns(const Robot& robot, std::string_view text, const std::string& file,
                             std::optional<InitTarget> given, const std::string& sockets_file,
                             const std::string& tip) {
  using namespace detail;
  const ReadTable table = read_table(text, file);
  const ColumnOfJoint joints = proposed_joints(robot, table, file, given && is_touched(*given));
  const std::optional<InitTarget> touched = touched_target(table, given, file);
  std::set<int> taken;
  for (const auto& [joint, column] : joints) taken.insert(column);
  const ColumnOfJoint velocities = proposed_velocities(robot, table, joints);
  for (const auto& [joint, column] : velocities) taken.insert(column);
  std::vector<PointColumns> points;
  if (!touched) {
    points = table.header ? measured_points(table, taken, file) : std::vector{last_three(table)};
  } else if (*touched == InitTarget::sockets) {
    taken.insert(socket_column(table));
  } else if (*touched == InitTarget::distance) {
    taken.insert(distance_column(table));
  } else if (*touched == InitTarget::gravity) {
    for (const int column : accelerometer_columns(table, file)) taken.insert(column);
  }
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
             "{} by the table's {}: check it.\n{}"
             "separator: {}\nheader: {}\n",
             kProposedColumnsMark,
             table.header ? "header and values" : "number of columns and values",
             touched ? fmt::format("{}{}\n", kTargetMark, to_string(*touched)) : "",
             separators.at(table.separator), table.header) +
         turning + sliding + velocities_text(robot, table, velocities, true, turning) +
         velocities_text(robot, table, velocities, false, sliding) +
         (touched ? touched_text(robot, table, *touched, file, sockets_file, tip)
                  : observations_text(robot, table, points)) +
         (unused.empty() ? "" : "\n# Not used: " + unused + "\n");
}

}  // namespace kinecal
