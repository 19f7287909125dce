// The walker that also notes, for each parameter it meets, the twist by which that parameter moves
// everything after it.
//
// A change of one joint offset or frame component moves the rest of the chain as a rigid body:
//
//   dp/dparameter = linear + angular x p          for every point p after the joint, in the base
//
// found once per sample and joint, for all points.  With R, o the rotation and origin of the frame
// in front of the joint, J the left Jacobian of its correction:
//
//   translation k    linear = R e_k                    angular = 0
//   rotation k       angular = R J e_k                 linear = o' x angular,  o' = o + R t
//   turning joint    angular = R a                     linear = o x angular
//   sliding joint    linear = R a                      angular = 0
//
// A joint passed from child to parent moves what comes after it the other way: the same formulas
// at the frame behind it, negated.  Source: Murray, Li, Sastry, A Mathematical Introduction to
// Robotic Manipulation, 3.4 (spatial Jacobian).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "kinecal/kinematics/pose_walker.hpp"

namespace kinecal {

/// Where the parameters of a joint stand in a vector of parameters (or which columns of a Jacobian
/// are theirs); -1: nowhere.
struct JointIndices {
  int offset = -1;
  double gain = 1.0;  ///< of the offset: the multiplier of a mimic joint
  std::array<int, 6> frame = {-1, -1, -1, -1, -1, -1};  ///< x y z a b c
};

/// How one parameter moves all points behind its joint; in the base, per unit of the parameter.
template <class S>
struct Twist {
  int column;
  Vector3<S> linear, angular;

  [[nodiscard]] Vector3<S> velocity(const Vector3<S>& p_base) const {
    return linear + angular.cross(p_base);
  }
};

template <class S>
struct TwistWalker {
  std::span<const JointIndices> columns;  ///< of the free parameters, one per joint of the chain
  PoseWalker<S> walker = {};
  std::vector<Twist<S>> twists = {};

  void fixed(const Pose<double>& transform) { walker.fixed(transform); }

  template <class U>
  void correct(std::size_t i, const ChainJoint& joint, const JointCorrection<U>& correction) {
    if (joint.reversed) walker.correct(i, joint, correction);
    const S sign(joint.reversed ? -1.0 : 1.0);
    const Pose<S>& front = walker.pose;
    const Vector3<S> pivot = front * correction.frame.translation;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      if (const int column = columns[i].frame[axis]; column >= 0) {
        twists.push_back({column, front.rotation.col(k) * sign, Vector3<S>::Zero()});
      }
      if (const int column = columns[i].frame[axis + 3]; column >= 0) {
        const Vector3<U> turn = correction.left_jacobian.col(k);
        const Vector3<S> angular = rotated(front.rotation, turn) * sign;
        twists.push_back({column, pivot.cross(angular), angular});
      }
    }
    if (!joint.reversed) walker.correct(i, joint, correction);
  }

  template <class U>
  void move(std::size_t i, const ChainJoint& joint, const Motion<U>& motion) {
    walker.move(i, joint, motion);  // a joint's axis is the same before and after it
    const int column = columns[i].offset;
    if (column < 0) return;
    const S gain(joint.reversed ? -columns[i].gain : columns[i].gain);
    const Vector3<S> axis = rotated(walker.pose.rotation, joint.axis) * gain;
    if (turns(joint.type)) {
      twists.push_back({column, walker.pose.translation.cross(axis), axis});
    } else {
      twists.push_back({column, axis, Vector3<S>::Zero()});
    }
  }
};

}  // namespace kinecal
