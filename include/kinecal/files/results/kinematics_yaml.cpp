// Definitions of kinematics_yaml.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/kinematics_yaml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// An entry of the file: its name, and its joint; of a joint that the robot does not have, "".
using KinematicsEntries = std::vector<std::pair<std::string, std::string>>;

/// What the names of an arm's joints begin with.
/// @param first   the name of its first joint without that
/// @param given   what they begin with at least
/// @param why_not  receives the reason if there is no arm, or more than one
[[nodiscard]] std::optional<std::string> arm_prefix(const Robot& robot, std::string_view first,
                                                    const std::string& given,
                                                    std::string& why_not) {
  std::vector<std::string> found;
  for (const Joint& joint : robot.joints()) {
    if (!joint.name.ends_with(first) || !joint.name.starts_with(given)) continue;
    found.push_back(joint.name.substr(0, joint.name.size() - first.size()));
  }
  if (found.size() == 1) return found.front();
  why_not = found.empty() ? fmt::format("the robot has no joint '{}{}'", given, first)
                          : fmt::format("the robot has several arms: give {}=FILE for each",
                                        fmt::join(found, "=FILE, "));
  return std::nullopt;
}

/// UR's six joints, whose names may all begin with a prefix.
/// @param why_not  receives the reason if the robot is not one of UR's
[[nodiscard]] KinematicsEntries ur_entries(const Robot& robot, const std::string& given,
                                           std::string& why_not) {
  const auto prefix = arm_prefix(robot, kUrJoints.front().joint, given, why_not);
  if (!prefix) return {};
  KinematicsEntries entries;
  for (const auto& [entry, joint] : kUrJoints)
    entries.emplace_back(entry, *prefix + std::string(joint));
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

/// The joints that begin with a prefix, by their own names.
[[nodiscard]] KinematicsEntries own_entries(const Robot& robot, const std::string& prefix) {
  KinematicsEntries entries;
  for (const Joint& joint : robot.joints()) {
    if (joint.name.starts_with(prefix)) entries.emplace_back(joint.name, joint.name);
  }
  return entries;
}

constexpr const char* kFrankaFirst = "joint1";
constexpr const char* kFrankaKey = "kinematic";

/// A file with the origins of joints.
struct KinematicsFile {
  YamlNode origins;        ///< by entry
  bool is_franka = false;  ///< each origin is below `kinematic:`

  /// The origin's numbers of an entry; nullptr without them.
  [[nodiscard]] const YamlNode* origin(std::string_view entry) const {
    const YamlNode* of = origins.find(entry);
    if (of != nullptr && is_franka) of = of->find(kFrankaKey);
    return of != nullptr && of->is_map() ? of : nullptr;
  }
  [[nodiscard]] bool is_of_ur() const {
    return !is_franka && std::all_of(kUrJoints.begin(), kUrJoints.end(), [&](const UrJoint& of) {
      return origin(of.entry) != nullptr;
    });
  }
};

/// @throws InputError  if a file of Franka has more than origins, which would be lost
void check_only_origins(const YamlNode& document, const std::string& file) {
  constexpr std::array<std::string_view, 6> kKeys = {"x", "y", "z", "roll", "pitch", "yaw"};
  const auto refuse = [&](const YamlNode& key) {
    throw InputError(
        fmt::format("{}: '{}' is no origin of a joint and would be lost; choose another name",
                    SourceLocation{file, key.line}.str(), key.text));
  };
  for (std::size_t i = 0; i < document.items.size(); ++i) {
    const YamlNode& joint = document.items[i];
    if (!joint.is_map() || joint.items.empty()) refuse(document.keys[i]);
    for (std::size_t k = 0; k < joint.items.size(); ++k) {
      if (joint.keys[k].text != kFrankaKey || !joint.items[k].is_map()) refuse(joint.keys[k]);
      for (const YamlNode& key : joint.items[k].keys) {
        if (std::find(kKeys.begin(), kKeys.end(), key.text) == kKeys.end()) refuse(key);
      }
    }
  }
}

/// @throws InputError  if it has no origins
[[nodiscard]] KinematicsFile existing_kinematics(const std::string& text, const std::string& file) {
  Diagnostics diagnostics;
  const YamlNode document = parse_config_text(text, file, diagnostics);
  diagnostics.throw_if_errors();
  const YamlNode* kinematics = document.find("kinematics");
  if (kinematics != nullptr && kinematics->is_map()) return {*kinematics, false};
  KinematicsFile franka{document, true};
  if (franka.origin(kFrankaFirst) != nullptr) {
    check_only_origins(document, file);
    return franka;
  }
  throw InputError(
      file + ": exists and has no 'kinematics:' with the origins of joints; choose another name");
}

/// The entries of a file.
/// @throws InputError  if it is UR's or Franka's, and the robot is not
[[nodiscard]] KinematicsEntries entries_of(const KinematicsFile& of, const Robot& robot,
                                           const std::string& given, const std::string& file) {
  std::string why_not;
  if (of.is_franka) {
    const auto prefix = arm_prefix(robot, kFrankaFirst, given, why_not);
    if (!prefix) {
      throw InputError(fmt::format("{}: is a file of Franka, but {}", file, why_not));
    }
    KinematicsEntries entries;
    for (const YamlNode& key : of.origins.keys) {
      const std::string joint = *prefix + key.text;
      entries.emplace_back(key.text, robot.has_joint(joint) ? joint : "");
    }
    return entries;
  }
  if (!of.is_of_ur()) return own_entries(robot, given);
  KinematicsEntries entries = ur_entries(robot, given, why_not);
  if (entries.empty()) {
    throw InputError(
        fmt::format("{}: is a calibration of UR, but {}; choose another name", file, why_not));
  }
  return entries;
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

/// An entry of a file.
[[nodiscard]] std::string origin_yaml(const std::string& name, const Pose<double>& origin,
                                      bool is_franka) {
  const Vector3<double>& xyz = origin.translation;
  const Vector3<double> rpy = rpy_from_rotation(origin.rotation);
  const auto number = [](double value) { return number_to_yaml(value + 0.0); };
  const std::string begin = is_franka ? fmt::format("{}:\n  {}:\n", name_to_yaml(name), kFrankaKey)
                                      : fmt::format("  {}:\n", name_to_yaml(name));
  return fmt::format(
      "{}    x: {}\n    y: {}\n    z: {}\n    roll: {}\n    pitch: {}\n    yaw: {}\n", begin,
      number(xyz.x()), number(xyz.y()), number(xyz.z()), number(rpy.x()), number(rpy.y()),
      number(rpy.z()));
}

}  // namespace
}  // namespace detail

std::string kinematics_difference(const Robot& robot, const std::string& existing,
                                  const std::string& file, const std::string& prefix) {
  constexpr double kMetres = 1e-5, kRadians = 1e-5;  // the digits of a file
  const detail::KinematicsFile before = detail::existing_kinematics(existing, file);
  std::string differences;
  for (const auto& [entry, joint] : detail::entries_of(before, robot, prefix, file)) {
    const detail::YamlNode* of = before.origin(entry);
    if (of == nullptr || joint.empty()) continue;
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
                            const std::string& existing, const std::string& file,
                            const std::string& prefix) {
  std::optional<detail::KinematicsFile> before;
  if (!existing.empty()) before = detail::existing_kinematics(existing, file);
  std::string why_not;
  detail::KinematicsEntries entries;
  if (before && (before->is_franka || before->is_of_ur())) {
    entries = detail::entries_of(*before, robot, prefix, file);
  } else {
    entries = detail::ur_entries(robot, prefix, why_not);
  }
  const bool is_franka = before && before->is_franka, is_ur = !entries.empty() && !is_franka;
  if (entries.empty()) entries = detail::own_entries(robot, prefix);
  if (entries.empty()) {
    throw InputError(fmt::format("{}: no joint of the robot begins with '{}'", file, prefix));
  }
  const std::map<std::string, Pose<double>> origins = calibrated_origins(robot, patches);
  std::string text = fmt::format("{}\n{}", kKinematicsMark, is_franka ? "" : "kinematics:\n");
  for (const auto& [entry, joint] : entries) {
    const Pose<double> origin =
        joint.empty() ? detail::origin_of(*before->origin(entry), entry, file) : origins.at(joint);
    text += detail::origin_yaml(entry, origin, is_franka);
  }
  if (!is_ur) return text;
  const detail::YamlNode* hash = before ? before->origins.find("hash") : nullptr;
  return text + (hash != nullptr && hash->is_scalar()
                     ? fmt::format("  hash: {}\n", detail::name_to_yaml(hash->text))
                     : "  hash: calib_unknown  # ur_calibration writes the robot's; the driver "
                       "compares it\n");
}

std::string zeros_yaml(const Robot& robot, const std::vector<JointPatch>& patches, bool degrees) {
  std::string text = fmt::format("{}\n# Units: {}\n", kZerosMark,
                                 degrees ? "degrees and millimetres" : "radians and metres");
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    const auto patch = std::find_if(patches.begin(), patches.end(),
                                    [&](const JointPatch& one) { return one.joint == joint.name; });
    const double unit = !degrees ? 1.0 : turns(joint.type) ? 180.0 / std::numbers::pi : 1e3;
    const double zero = patch == patches.end() ? 0.0 : patch->offset * unit;
    text += fmt::format("{}: {}\n", detail::name_to_yaml(joint.name), number_to_yaml(zero + 0.0));
  }
  return text;
}

}  // namespace kinecal
