// Corrections: what calibration adds to the joints of a chain, as plain values.
//
// A chain has one correction per joint, in its order.  Corrections do not know which parameters are
// free.  For forward kinematics, fill them by hand; a calibration fills them from its parameters
// once per evaluation, not once per sample.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/kinematics/static_chain.hpp"

namespace kinecal {

/// The correction of one joint: an offset of its position and a correction of its frame.
template <class S>
struct JointCorrection {
  JointState<S> offset;                               ///< added to the measured position
  Pose<S> frame;                                      ///< between the joint's origin and its motion
  Matrix3<S> left_jacobian = Matrix3<S>::Identity();  ///< of the frame's rotation vector
  std::vector<S> model;  ///< values of the parameters of its joint models; empty: it has none

  /// Sets the frame correction.
  /// @param translation      (3) metres, in the joint's frame
  /// @param rotation_vector  (3) radians, in the joint's frame
  void set_frame(const Vector3<S>& translation, const Vector3<S>& rotation_vector) {
    frame = {exp(rotation_vector), translation};
    left_jacobian = kinecal::left_jacobian(rotation_vector);
  }
};

/// Corrections of a chain's joints, in the order of the chain.
template <class S>
using Corrections = std::vector<JointCorrection<S>>;

/// The joints of a chain, from base to tip.
[[nodiscard]] inline const std::vector<ChainJoint>& joints_of(const RuntimeChain& chain) {
  return chain.joints;
}
/// The joints of a chain that the compiler knows.
template <StaticChain C>
[[nodiscard]] constexpr const auto& joints_of(const C&) {
  return C::kJoints;
}

/// The measured motions of a chain's joints in one sample, with what their joint models need.
struct ModelledMotions {
  std::vector<JointState<double>> measured;  ///< of each joint
  /// Of each joint: by how much a unit of each parameter of its models moves it, radians or metres.
  std::vector<std::vector<double>> all_effects;

  /// The measured motion of a joint.
  [[nodiscard]] const JointState<double>& operator[](std::size_t joint) const {
    return measured[joint];
  }
  /// The effects of the parameters of its models.
  [[nodiscard]] const double* effects(std::size_t joint) const { return all_effects[joint].data(); }
};

/// The measured motion of each joint of a chain in one sample.
/// @param chain        a RuntimeChain or a Chain
/// @param position_of  callable: name of a joint -> its measured position, radians or metres
template <class Chain, class PositionOf>
[[nodiscard]] std::vector<JointState<double>> measured_joint_states(const Chain& chain,
                                                                    PositionOf&& position_of) {
  std::vector<JointState<double>> motions;
  motions.reserve(joints_of(chain).size());
  for (const auto& joint : joints_of(chain)) {
    const auto& drive = joint.drive;
    motions.push_back(
        moves(joint.type)
            ? make_joint_state(drive.multiplier * position_of(std::string(drive.joint)) +
                               drive.offset)
            : JointState<double>{});
  }
  return motions;
}

}  // namespace kinecal
