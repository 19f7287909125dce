// Definitions of homing_offsets.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/homing_offsets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/json/json_value.hpp"
#include "kinecal/files/xml/xml_edit.ipp"

namespace kinecal {

namespace detail {
namespace {

// Where the numbers of a JSON text are, so that one can be replaced and all else stays.

/// Begin and end of a number in a text.
struct NumberPlace {
  std::size_t begin, end;
};

/// The numbers of the objects in an object, by the two names: {"elbow": {"id": 3}} has ("elbow", "id").
/// @param text  JSON, as JsonValue::parse() took it
[[nodiscard]] std::map<std::pair<std::string, std::string>, NumberPlace> number_places(
    std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  std::map<std::pair<std::string, std::string>, NumberPlace> places;
  std::vector<std::string> names(3);  // of the fields that the position is in, by depth
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (c != '"') continue;
    const std::size_t begin = at++;
    while (text[at] != '"') at += text[at] == '\\' ? 2 : 1;
    const std::size_t colon = text.find_first_not_of(kSpace, at + 1);
    if (colon >= text.size() || text[colon] != ':' || depth >= names.size()) continue;
    const std::string_view quoted = text.substr(begin, at + 1 - begin);
    names[depth] = JsonValue::parse(quoted).as_text();
    const std::size_t value = text.find_first_not_of(kSpace, colon + 1);
    const std::size_t end = text.find_first_of(",}] \t\r\n", value);
    const bool is_number = text[value] == '-' || (text[value] >= '0' && text[value] <= '9');
    if (depth == 2 && is_number) places[{names[1], names[2]}] = {value, end};
  }
  return places;
}

/// A motor of the file.
struct Motor {
  std::string name;
  std::int64_t homing_offset = 0;  ///< ticks
  double direction = 1.0;          ///< of the joint, where the servo counts up
};

/// The largest homing offset that a servo holds, ticks.
[[nodiscard]] std::int64_t most_ticks(ServoMake make) {
  return make == ServoMake::feetech ? 2047 : 1044479;
}

/// @throws InputError  if the text is not LeRobot's
[[nodiscard]] std::vector<Motor> motors_of(const std::string& text, const std::string& file) {
  try {
    const JsonValue root = JsonValue::parse(text);
    if (root.find("motor_names")) {
      throw JsonError("it is of a LeRobot before June 2025; calibrate with a newer one first");
    }
    std::vector<Motor> motors;
    for (const auto& [name, motor] : root.fields()) {
      const std::int64_t mode = motor.find("drive_mode") ? motor.integer("drive_mode") : 0;
      if (mode != 0 && mode != 1) {
        throw JsonError(fmt::format("drive_mode of '{}' must be 0 or 1, is {}", name, mode));
      }
      motors.push_back({name, motor.integer("homing_offset"), mode == 0 ? 1.0 : -1.0});
    }
    return motors;
  } catch (const JsonError& error) {
    throw InputError(file + ": " + error.what());
  }
}

/// The zero of a joint, radians; nullopt if a servo cannot hold it.
[[nodiscard]] std::optional<double> zero_of(const Robot& robot,
                                            const std::vector<JointPatch>& patches,
                                            const std::string& joint) {
  if (!robot.has_joint(joint) || !turns(robot.joint(joint).type)) return std::nullopt;
  const auto patch = std::find_if(patches.begin(), patches.end(),
                                  [&](const JointPatch& of) { return of.joint == joint; });
  return patch == patches.end() ? 0.0 : patch->offset;
}

/// The motor's homing offset with a zero added.
/// @param zero  radians
/// @param change  receives a sentence
[[nodiscard]] std::int64_t with_zero(const Motor& motor, double zero, ServoMake make,
                                     const std::string& file, std::string& change) {
  constexpr double kTicksPerRadian = 4096.0 / (2.0 * std::numbers::pi);
  constexpr double kDegree = std::numbers::pi / 180.0;
  const double ticks = zero * kTicksPerRadian;
  const double sign = make == ServoMake::feetech ? -motor.direction : motor.direction;
  const std::int64_t offset = motor.homing_offset + std::llround(sign * ticks);
  change = fmt::format("{}: homing_offset {} becomes {} ({:.3f} degrees are {:.2f} ticks)",
                       motor.name, motor.homing_offset, offset, zero / kDegree, ticks);
  if (std::abs(offset) <= most_ticks(make)) return offset;
  throw InputError(
      fmt::format("{}: {}, but the servo holds only {} to {}; turn its horn or home it again", file,
                  change, -most_ticks(make), most_ticks(make)));
}

}  // namespace
}  // namespace detail

HomingPatch patch_homing_offsets(const std::string& text, const std::string& file,
                                 const Robot& robot, const std::vector<JointPatch>& patches,
                                 ServoMake make) {
  const std::vector<detail::Motor> motors = detail::motors_of(text, file);
  const auto places = detail::number_places(text);
  HomingPatch patch;
  std::vector<detail::TextEdit> edits;
  for (const detail::Motor& motor : motors) {
    const std::optional<double> zero = detail::zero_of(robot, patches, motor.name);
    if (!zero) {
      patch.unused.push_back(motor.name);
      continue;
    }
    if (*zero == 0.0) continue;
    const std::int64_t offset =
        detail::with_zero(motor, *zero, make, file, patch.changes.emplace_back());
    const detail::NumberPlace at = places.at({motor.name, "homing_offset"});
    edits.push_back({at.begin, at.end - at.begin, fmt::format("{}", offset)});
  }
  for (const JointPatch& of : patches) {
    const auto has_its_name = [&](const detail::Motor& motor) { return motor.name == of.joint; };
    const bool moves_zero = of.offset != 0.0;
    if (moves_zero && std::none_of(motors.begin(), motors.end(), has_its_name))
      patch.missing.push_back(of.joint);
  }
  if (patch.unused.size() == motors.size()) {
    throw InputError(
        fmt::format("{}: no motor has the name of a joint that rotates; motors: {}; joints: {}",
                    file, fmt::join(patch.unused, ", "), fmt::join(robot.joint_names(), ", ")));
  }
  patch.text = detail::apply_edits(text, std::move(edits));
  return patch;
}

std::set<std::string> servo_joints(const std::string& text, const std::string& file,
                                   const Robot& robot) {
  std::set<std::string> joints;
  for (const detail::Motor& motor : detail::motors_of(text, file)) {
    if (detail::zero_of(robot, {}, motor.name)) joints.insert(motor.name);
  }
  return joints;
}

}  // namespace kinecal
