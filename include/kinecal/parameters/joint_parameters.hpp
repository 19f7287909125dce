// The offsets of joints as parameters.
//
// A frame's parameters are kFrameParameters; joint models, sensors and error blocks list theirs as
// kParameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/kinematics/joint.hpp"
#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

/// Adds the offset of a joint that moves, unless the table already has it.
inline void add_joint_offset(ParameterTable& table, std::string_view joint, JointType type) {
  const std::string name(joint);
  if (table.find(name) >= 0) return;
  table.add({.name = name, .unit = std::string(position_unit(type))});
}

}  // namespace kinecal
