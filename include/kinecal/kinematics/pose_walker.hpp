// The walker that composes the pose of the tip, in any scalar: double, Jet, packet.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/walk.hpp"

namespace kinecal {

template <class S>
struct PoseWalker {
  Pose<S> pose;  ///< of the frame reached so far, in the base

  void fixed(const Pose<double>& transform) { pose = pose * transform; }

  template <class U>
  void correct(std::size_t, const ChainJoint& joint, const JointCorrection<U>& correction) {
    pose = joint.reversed ? pose * correction.frame.inverse() : pose * correction.frame;
  }

  template <class U>
  void move(std::size_t, const ChainJoint& joint, const Motion<U>& motion) {
    pose = pose * joint_pose(joint.type, joint.axis, joint.reversed ? motion.inverse() : motion);
  }
};

static_assert(Walker<PoseWalker<double>, double>);

/// Forward kinematics: the pose of the chain's tip in its base.
/// @param position_of  callable: name of a joint -> its measured position, radians or metres
/// @param corrections  one per joint of the chain
template <std::size_t N, class PositionOf, class S>
[[nodiscard]] Pose<S> forward_kinematics(const Chain<N>& chain, PositionOf&& position_of,
                                         const Corrections<S>& corrections) {
  const std::vector<Motion<double>> motions = measured_motions(chain, position_of);
  PoseWalker<S> walker;
  walk(chain, std::span<const Motion<double>>(motions),
       std::span<const JointCorrection<S>>(corrections), walker);
  return walker.pose;
}

/// Forward kinematics of the robot as it is, without corrections.
template <std::size_t N, class PositionOf>
[[nodiscard]] Pose<double> forward_kinematics(const Chain<N>& chain, PositionOf&& position_of) {
  return forward_kinematics(chain, position_of, Corrections<double>(chain.joints.size()));
}

}  // namespace kinecal
