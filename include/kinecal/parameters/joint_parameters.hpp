// The parameters that the joints of a robot declare: offsets, and those of joint models.
//
// A frame's are kFrameParameters; sensors and error blocks list theirs as kParameters.
// add_parameters() puts all of them into a table.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "kinecal/kinematics/joint_model.hpp"
#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

/// The parameters of all joint models, of a joint that rotates.
inline constexpr auto kJointModelParameters = [] {
  OfJointModels<ParameterInfo> all;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = {kJointModelNames[k], kJointModelUnits[k]};
  return all;
}();
/// Index of a parameter of joint models, "gear_ratio"; kJointModelSize if there is none.
[[nodiscard]] constexpr std::size_t joint_model_index(std::string_view name) {
  std::size_t k = 0;
  while (k < kJointModelSize && kJointModelNames[k] != name) ++k;
  return k;
}
/// True if a joint of this type, which moves, may have a parameter of joint models.
[[nodiscard]] constexpr bool may_have_model(JointType type, std::size_t k) {
  return turns(type) || !kJointModelRotatesOnly[k];
}

/// Adds the offset of a joint that moves, unless the table already has it.
inline void add_joint_offset(ParameterTable& table, std::string_view joint, JointType type) {
  const std::string name(joint);
  if (table.find(name) >= 0) return;
  table.add({.name = name, .unit = std::string(position_unit(type))});
}
/// Adds a parameter of joint models, unless the table already has it.
inline void add_joint_model_parameter(ParameterTable& table, std::string_view joint,
                                      std::size_t k) {
  add_parameters(table, joint, {&kJointModelParameters[k], 1});
}

}  // namespace kinecal
