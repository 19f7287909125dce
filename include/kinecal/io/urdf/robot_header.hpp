// The robot of a URDF as a C++ header: constant data, which is a RobotData.
//
// The program kinecal_robot_header writes it, which kinecal_add_robot() runs when a project is
// built.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/urdf/cpp_text.hpp"
#include "kinecal/io/urdf/read_urdf.hpp"

namespace kinecal {

namespace detail {

/// The joints in the order of the text, but none in front of the one that moves its parent link.
[[nodiscard]] inline std::vector<const Joint*> joints_parents_first(const Robot& robot) {
  std::vector<const Joint*> ordered;
  std::set<const Joint*> placed;
  for (const Joint& joint : robot.joints()) {
    const std::vector<const Joint*> way = joints_to_root(robot, joint.child);
    for (auto above = way.rbegin(); above != way.rend(); ++above) {
      if (placed.insert(*above).second) ordered.push_back(*above);
    }
  }
  return ordered;
}

/// The initializer of a JointData.
[[nodiscard]] inline std::string joint_initializer(const Joint& joint) {
  const auto row = [&](int i) {
    const Vector3<double> numbers = joint.origin.rotation.row(i);
    return cpp_numbers({numbers.data(), 3});
  };
  std::string text = fmt::format(
      R"(      {{.name = {},
       .type = kinecal::JointType::{},
       .parent = {},
       .child = {},
       .origin = {{.rotation = {{{},
                               {},
                               {}}},
                  .translation = {{{}}}}},
       .axis = {{{}}})",
      cpp_string(joint.name), to_string(joint.type), cpp_string(joint.parent),
      cpp_string(joint.child), row(0), row(1), row(2),
      cpp_numbers({joint.origin.translation.data(), 3}), cpp_numbers({joint.axis.data(), 3}));
  if (joint.mimic) {
    text += fmt::format(",\n       .mimic = kinecal::MimicData{{{}, {}}}",
                        cpp_string(joint.mimic->joint),
                        cpp_numbers({{joint.mimic->multiplier, joint.mimic->offset}}));
  }
  if (joint.limits) {
    text += fmt::format(",\n       .limits = kinecal::LimitsData{{{}}}",
                        cpp_numbers({{joint.limits->lower, joint.limits->upper}}));
  }
  return text + "},\n";
}

/// The namespace of a robot's header: the one that was asked for or else the robot's name.
/// @throws InputError  if it is none
[[nodiscard]] inline std::string robot_namespace(const UrdfText& source,
                                                 const std::string& asked_for) {
  if (is_namespace(asked_for)) return asked_for;
  if (!asked_for.empty()) {
    throw InputError("'" + asked_for +
                     "' cannot be a namespace; choose an identifier that neither C++ nor kinecal "
                     "has taken, such as 'my_robot'");
  }
  const std::string name = source.robot().attribute("name").value();
  std::string words = joined_words(name);
  if (is_namespace(words)) return words;
  throw InputError(source.place(source.robot()).str() + ": the robot's name '" + name +
                   "' cannot be made a namespace; choose one (NAMESPACE)");
}

}  // namespace detail

/// The text of a header with the robot that a URDF describes, `<namespace>::Robot`.
/// @param path        of the URDF
/// @param name_space  such as `fetch` or `robots::fetch`; empty: the robot's name
/// @throws InputError  as read_urdf(), and if the namespace is none
[[nodiscard]] inline std::string robot_header(const std::string& path,
                                              const std::string& name_space = "") {
  const std::string urdf = read_urdf_text(path);
  const Robot robot = parse_urdf(urdf, path);
  const std::string space = detail::robot_namespace(UrdfText(urdf, path), name_space);
  std::string joints;
  for (const Joint* joint : detail::joints_parents_first(robot)) {
    joints += detail::joint_initializer(*joint);
  }
  return fmt::format(
      R"(// Generated from {}; changes are lost.
#pragma once

#include "kinecal/kinematics/robot_data.hpp"

namespace {} {{

struct Robot {{
  static constexpr std::string_view kName = {};
  static constexpr std::array<kinecal::JointData, {}> kJoints = {};
}};
static_assert(kinecal::RobotData<Robot>);

}}  // namespace {}
)",
      detail::cpp_string(std::filesystem::path(path).filename().string()), space,
      detail::cpp_string(robot.name()), robot.joints().size(),
      joints.empty() ? "{}" : "{{\n" + joints + "  }}", space);
}

}  // namespace kinecal
