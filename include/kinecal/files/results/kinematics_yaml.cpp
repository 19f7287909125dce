// Definitions of kinematics_yaml.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/kinematics_yaml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/geometry/rpy.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A name in UR's file, and the joint whose origin it holds.
struct UrJoint {
  std::string_view entry, joint;
};

constexpr std::array<UrJoint, 6> kUrJoints = {{{"shoulder", "shoulder_pan_joint"},
                                               {"upper_arm", "shoulder_lift_joint"},
                                               {"forearm", "elbow_joint"},
                                               {"wrist_1", "wrist_1_joint"},
                                               {"wrist_2", "wrist_2_joint"},
                                               {"wrist_3", "wrist_3_joint"}}};

/// An entry of the file: its name, and its joint.
using KinematicsEntries = std::vector<std::pair<std::string, std::string>>;

/// UR's six joints, whose names may all begin with a prefix.
/// @param why_not  receives the reason if the robot is not one of UR's
[[nodiscard]] KinematicsEntries ur_entries(const Robot& robot, std::string& why_not) {
  const std::string_view first = kUrJoints.front().joint;
  KinematicsEntries entries;
  for (const Joint& shoulder : robot.joints()) {
    if (!shoulder.name.ends_with(first)) continue;
    if (!entries.empty()) {
      why_not = "the robot has several arms of UR";
      return {};
    }
    const std::string prefix = shoulder.name.substr(0, shoulder.name.size() - first.size());
    for (const auto& [entry, joint] : kUrJoints)
      entries.emplace_back(entry, prefix + std::string(joint));
  }
  if (entries.empty()) why_not = fmt::format("the robot has no joint '{}'", first);
  for (const auto& [entry, name] : entries) {
    if (!robot.has_joint(name)) {
      why_not = fmt::format("the robot has no joint '{}'", name);
    } else if (const Joint& joint = robot.joint(name);
               !turns(joint.type) || joint.axis != Vector3<double>::UnitZ()) {
      why_not =
          fmt::format("joint '{}' does not rotate about z, as in UR's descriptions of today", name);
    }
  }
  if (!why_not.empty()) entries.clear();
  return entries;
}

/// The map below `kinematics:` of a file.
/// @throws InputError  if it is not there
[[nodiscard]] YamlNode existing_kinematics(const std::string& text, const std::string& file) {
  Diagnostics diagnostics;
  const YamlNode document = parse_config_text(text, file, diagnostics);
  diagnostics.throw_if_errors();
  const YamlNode* kinematics = document.find("kinematics");
  if (kinematics != nullptr && kinematics->is_map()) return *kinematics;
  throw InputError(
      file + ": exists and has no 'kinematics:' with the origins of joints; choose another name");
}

[[nodiscard]] bool is_of_ur(const YamlNode& kinematics) {
  return std::all_of(kUrJoints.begin(), kUrJoints.end(), [&](const UrJoint& of) {
    const YamlNode* entry = kinematics.find(of.entry);
    return entry != nullptr && entry->is_map();
  });
}

/// The origin of an entry.
/// @throws InputError  if a number is missing
[[nodiscard]] Pose<double> origin_of(const YamlNode& entry, const std::string& name,
                                     const std::string& file) {
  const auto number = [&](const char* key) {
    const YamlNode* node = entry.find(key);
    const std::optional<double> value = node != nullptr ? config_number(*node) : std::nullopt;
    if (value && std::isfinite(*value)) return *value;
    throw InputError(fmt::format("{}: '{}' has no number {}",
                                 SourceLocation{file, entry.line}.str(), name, key));
  };
  return {rotation_from_rpy(Vector3<double>(number("roll"), number("pitch"), number("yaw"))),
          {number("x"), number("y"), number("z")}};
}

[[nodiscard]] std::string origin_yaml(const std::string& name, const Pose<double>& origin) {
  const Vector3<double>& xyz = origin.translation;
  const Vector3<double> rpy = rpy_from_rotation(origin.rotation);
  const auto number = [](double value) { return number_to_yaml(value + 0.0); };
  return fmt::format(
      "  {}:\n    x: {}\n    y: {}\n    z: {}\n    roll: {}\n    pitch: {}\n    yaw: {}\n",
      name_to_yaml(name), number(xyz.x()), number(xyz.y()), number(xyz.z()), number(rpy.x()),
      number(rpy.y()), number(rpy.z()));
}

}  // namespace
}  // namespace detail

std::string kinematics_difference(const Robot& robot, const std::string& existing,
                                  const std::string& file) {
  constexpr double kMetres = 1e-5, kRadians = 1e-5;  // the digits of a file
  const detail::YamlNode kinematics = detail::existing_kinematics(existing, file);
  std::string unused, differences;
  detail::KinematicsEntries entries = detail::ur_entries(robot, unused);
  if (entries.empty() || !detail::is_of_ur(kinematics)) {
    entries.clear();
    for (const Joint& joint : robot.joints()) entries.emplace_back(joint.name, joint.name);
  }
  for (const auto& [entry, joint] : entries) {
    const detail::YamlNode* of = kinematics.find(entry);
    if (of == nullptr || !of->is_map()) continue;
    const Pose<double> difference =
        detail::origin_of(*of, entry, file).inverse() * robot.joint(joint).origin;
    const double shift = difference.translation.norm(), turn = log(difference.rotation).norm();
    std::string by;
    if (shift > kMetres) by = fmt::format("{:.2g} mm", 1e3 * shift);
    if (turn > kRadians) {
      by += fmt::format("{}{:.2g} deg", by.empty() ? "" : " and ", turn * 180.0 / std::numbers::pi);
    }
    if (by.empty()) continue;
    differences += fmt::format("{}{} by {}", differences.empty() ? "" : ", ", entry, by);
  }
  return differences;
}

std::string kinematics_yaml(const Robot& robot, const std::vector<JointPatch>& patches,
                            const std::string& existing, const std::string& file) {
  std::optional<detail::YamlNode> before;
  if (!existing.empty()) before = detail::existing_kinematics(existing, file);
  std::string why_not;
  detail::KinematicsEntries entries = detail::ur_entries(robot, why_not);
  const bool is_ur = !entries.empty();
  if (before && detail::is_of_ur(*before) && !is_ur) {
    throw InputError(file + ": is a calibration of UR, but " + why_not + "; choose another name");
  }
  if (!is_ur) {
    for (const Joint& joint : robot.joints()) entries.emplace_back(joint.name, joint.name);
  }
  const std::map<std::string, Pose<double>> origins = calibrated_origins(robot, patches);
  std::string text = fmt::format("{}\nkinematics:\n", kKinematicsMark);
  for (const auto& [entry, joint] : entries) text += detail::origin_yaml(entry, origins.at(joint));
  if (!is_ur) return text;
  const detail::YamlNode* hash = before ? before->find("hash") : nullptr;
  return text + (hash != nullptr && hash->is_scalar()
                     ? fmt::format("  hash: {}\n", detail::name_to_yaml(hash->text))
                     : "  hash: calib_unknown  # ur_calibration writes the robot's; the driver "
                       "compares it\n");
}

}  // namespace kinecal
