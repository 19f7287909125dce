// The walker (visitor of the forward pass) that composes the pose of the tip, in any scalar.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/walk.hpp"

namespace kinecal {

/// A Walker: composes base_T_tip.
template <class S>
struct PoseWalker {
  Pose<S> pose;  ///< of the frame reached so far, in the base

  /// Passes a constant transform.
  void fixed(const ConstantPose& transform) {
    if (transform.rotates) {
      copy_numbers(pose * static_cast<const Pose<double>&>(transform), pose);
    } else {
      pose.translation = pose * transform.translation;
    }
  }

  /// Passes a constant transform that the compiler knows.
  template <class C, std::size_t I>
  void fixed(const detail::FixedOf<C, I>&) {
    multiply_by_constant<detail::FixedOf<C, I>>(pose);
  }

  /// Passes a frame correction.
  template <class Joint, class U>
  void correct(std::size_t, const Joint& joint, const JointCorrection<U>& correction) {
    if (joint.reversed) {
      copy_numbers(pose * correction.frame.inverse(), pose);
    } else {
      copy_numbers(pose * correction.frame, pose);
    }
  }

  /// Passes a joint's motion.
  template <class Joint, class U>
  void move(std::size_t, const Joint& joint, const JointState<U>& motion) {
    if (!turns(joint.type)) {
      pose.translation += axis(joint) * S(joint.reversed ? U(-motion.position) : motion.position);
    } else if (joint.principal < 0) {
      turn_about(pose.rotation, joint.axis, joint.reversed ? motion.inverse() : motion);
    } else {
      const bool backwards = joint.reversed != (joint.axis(joint.principal) < 0.0);
      turn_about(pose.rotation, joint.principal, backwards ? motion.inverse() : motion);
    }
  }

  /// (3) axis of a joint in the base, while the walk is in the joint's frame.
  template <class Joint>
  [[nodiscard]] Vector3<S> axis(const Joint& joint) const {
    if (joint.principal < 0) return rotated(pose.rotation, Vector3<double>(joint.axis));
    const Vector3<S> column = joint.principal == 0   ? pose.rotation.col(0)
                              : joint.principal == 1 ? pose.rotation.col(1)
                                                     : pose.rotation.col(2);
    return joint.axis(joint.principal) < 0.0 ? Vector3<S>(-column) : column;
  }
};

}  // namespace kinecal
