// Finds the parameters of a chain's joints, and computes the joints' corrections from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/kinematics/twist_walker.hpp"
#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

/// The indices of the offset and frame of a joint in a chain.  A mimic joint uses the offset of the joint
/// that drives it.
/// @param find  callable (owner, part): index of a parameter, or -1; an offset has an empty part
template <class Joint, class Find>
[[nodiscard]] constexpr OffsetAndFrame joint_indices(const Joint& joint, const Find& find) {
  OffsetAndFrame indices;
  if (moves(joint.type)) {
    indices.offset = find(joint.drive.joint, "");
    indices.gain = joint.drive.multiplier;
  }
  for (std::size_t k = 0; k < 6 && joint.corrected; ++k) {
    indices.frame[k] = find(joint.name, kFrameAxes[k]);
  }
  return indices;
}

/// Table indices of the offset and frame of each joint of a chain.  SampledChain also knows its joint
/// models.
[[nodiscard]] inline std::vector<JointIndices> chain_parameters(const RuntimeChain& chain,
                                                                const ParameterTable& table) {
  std::vector<JointIndices> indices;
  for (const ChainJoint& joint : chain.joints) {
    const auto find = [&](std::string_view owner, std::string_view part) {
      return table.find(part.empty() ? std::string(owner) : parameter_name(owner, part));
    };
    indices.push_back({joint_indices(joint, find), {}});
  }
  return indices;
}

/// Columns of the Jacobian for table indices.
[[nodiscard]] inline std::vector<JointIndices> columns_of(const std::vector<JointIndices>& indices,
                                                          const FreeSet& free) {
  std::vector<JointIndices> columns = indices;
  for (JointIndices& joint : columns) {
    joint.offset = free.column(joint.offset);
    for (int& index : joint.model) index = free.column(index);
    for (int& axis : joint.frame) axis = free.column(axis);
  }
  return columns;
}

/// Computes the corrections of a chain's joints.
/// @param values       of all parameters of the table; any scalar
/// @param corrections  out, one per joint; reuses its memory between calls
template <class S>
void set_corrections(const std::vector<JointIndices>& indices, std::span<const S> values,
                     Corrections<S>& corrections) {
  const auto value = [&](int i) { return i < 0 ? S(0.0) : values[static_cast<std::size_t>(i)]; };
  corrections.resize(indices.size());
  for (std::size_t j = 0; j < indices.size(); ++j) {
    const JointIndices& joint = indices[j];
    if (joint.offset >= 0)
      corrections[j].offset = make_joint_state(S(value(joint.offset) * joint.gain));
    corrections[j].model.resize(joint.model.size());
    for (std::size_t k = 0; k < joint.model.size(); ++k) {
      corrections[j].model[k] = value(joint.model[k]);
    }
    bool corrected = false;
    for (int axis : joint.frame) corrected = corrected || axis >= 0;
    if (!corrected) continue;
    const auto& f = joint.frame;
    corrections[j].set_frame({value(f[0]), value(f[1]), value(f[2])},
                             {value(f[3]), value(f[4]), value(f[5])});
  }
}

/// The corrections of a chain's joints.
/// @param values  of all parameters of the table; any scalar
template <class S>
[[nodiscard]] Corrections<S> corrections_for(const std::vector<JointIndices>& indices,
                                             std::span<const S> values) {
  Corrections<S> corrections;
  set_corrections(indices, values, corrections);
  return corrections;
}

}  // namespace kinecal
