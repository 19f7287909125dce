// The text of a robot's header: definitions of robot_header.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/robot_header.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "kinecal/files/urdf/cpp_text.ipp"
#include "kinecal/files/urdf/read_urdf.hpp"

namespace kinecal {

std::string robot_header(const std::string& path, const std::string& name_space) {
  const std::string urdf = read_urdf_text(path);
  const Robot robot = parse_urdf(urdf, path);
  const std::string space = detail::robot_namespace(detail::UrdfText(urdf, path), name_space);
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
