// The walker (visitor of the forward pass) that also computes a twist for each free parameter: how
// the parameter moves everything after its joint.
//
// Changing a joint offset or frame component moves the rest of the chain as a rigid body:
//
//   dp/dparameter = linear + angular x p          for every point p after the joint, in the base
//
// So one twist per sample and parameter serves all points.  With R, o the rotation and origin of
// the frame before the joint, t and J the translation and left Jacobian of its correction, and a
// its axis:
//
//   translation k    linear = R e_k                    angular = 0
//   rotation k       angular = R J e_k                 linear = o' x angular,  o' = o + R t
//   turning joint    angular = R a                     linear = o x angular
//   sliding joint    linear = R a                      angular = 0
//   joint model      the twist of its joint times the effect of the parameter
//
// A joint passed from child to parent moves what follows the other way: the same formulas at the
// frame after the joint, negated.
// Source: Murray, Li, Sastry, A Mathematical Introduction to Robotic Manipulation, 3.4 (spatial
// Jacobian); ARCHITECTURE.md, idea 2: twists instead of Jacobian columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/pose_walker.hpp"

namespace kinecal {

/// Indices of a joint's offset and frame, in a parameter table or among the columns of a Jacobian;
/// -1 for a parameter that is absent.
struct OffsetAndFrame {
  int offset = -1;    ///< of the offset
  double gain = 1.0;  ///< of the offset: the multiplier of a mimic joint
  std::array<int, 6> frame = {-1, -1, -1, -1, -1, -1};  ///< of the frame correction: x y z a b c

  bool operator==(const OffsetAndFrame&) const = default;  ///< all members are equal
};
/// Indices of all parameters of a joint.
struct JointIndices : OffsetAndFrame {
  std::vector<int> model;  ///< of its joint models, in the order of its effects
};

/// The largest number of parameters of joint models that a joint of a chain has.
[[nodiscard]] inline std::size_t most_effects(std::span<const JointIndices> joints) {
  std::size_t most = 0;
  for (const JointIndices& joint : joints) most = std::max(most, joint.model.size());
  return most;
}

/// How one parameter moves all points after its joint; in the base, per unit of the parameter.
template <class S>
struct Twist {
  Vector3<S> linear;   ///< (3) velocity of the point at the base's origin, metres per unit
  Vector3<S> angular;  ///< (3) radians per unit

  /// dp/dparameter = linear + angular x p.
  /// @param p_base  (3) point, metres, in the base
  /// @returns       (3) metres per unit of the parameter, in the base
  [[nodiscard]] Vector3<S> velocity(const Vector3<S>& p_base) const {
    const Vector3<S>&v = linear, &p = p_base;
    const S x = in_register(angular.x()), y = in_register(angular.y()),
            z = in_register(angular.z());
    return {v.x() + y * p.z() - z * p.y(),  // two fused multiply-adds each
            v.y() + z * p.x() - x * p.z(), v.z() + x * p.y() - y * p.x()};
  }
  /// -velocity(p_base), at the same cost.
  [[nodiscard]] Vector3<S> opposite_velocity(const Vector3<S>& p_base) const {
    const Vector3<S>&v = linear, &p = p_base;
    const S x = in_register(angular.x()), y = in_register(angular.y()),
            z = in_register(angular.z());
    return {(z * p.y() - v.x()) - y * p.z(), (x * p.z() - v.y()) - z * p.x(),
            (y * p.x() - v.z()) - x * p.y()};
  }
};

/// The twists of a chain.  Translational ones move all points alike, so they are stored separately.
template <class S>
struct ChainTwists {
  std::vector<Twist<S>> rotational;       ///< rotational twists
  std::vector<Vector3<S>> translational;  ///< (3) linear parts of translational twists
};

/// The Jacobian's columns of a chain's twists, in the order in which the walker computes them.
struct TwistColumns {
  std::vector<int> rotational;     ///< of the rotational twists
  std::vector<int> translational;  ///< of the translational twists

  /// Makes room for one twist per column.
  template <class S>
  void resize(ChainTwists<S>& twists) const {
    twists.rotational.resize(this->rotational.size());
    twists.translational.resize(this->translational.size());
  }
};

/// The columns of the twists that a TwistWalker will compute.
/// @param columns  of the free parameters, by joint of the chain
[[nodiscard]] inline TwistColumns twist_columns(const RuntimeChain& chain,
                                                std::span<const JointIndices> columns) {
  TwistColumns result;
  const auto add = [](std::vector<int>& list, int column) {
    if (column >= 0) list.push_back(column);
  };
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    const auto frame = [&] {
      if (!joint.corrected) return;
      for (std::size_t k = 0; k < 3; ++k) add(result.translational, columns[i].frame[k]);
      for (std::size_t k = 3; k < 6; ++k) add(result.rotational, columns[i].frame[k]);
    };
    if (!joint.reversed) frame();
    if (moves(joint.type)) {
      std::vector<int>& list = turns(joint.type) ? result.rotational : result.translational;
      add(list, columns[i].offset);
      for (const int column : columns[i].model) add(list, column);
    }
    if (joint.reversed) frame();
  }
  return result;
}

/// A Walker: composes base_T_tip and fills the twists of a chain.
/// @tparam Columns  type of the free parameters' columns, by joint of the chain; constants for a
///                  chain that the compiler knows
template <class S, class Columns = std::span<const JointIndices>>
struct TwistWalker {
  Columns columns;            ///< of the free parameters, by joint of the chain
  Twist<S>* turn;             ///< where the next rotational twist is written
  Vector3<S>* shift;          ///< where the next translational twist is written
  PoseWalker<S> walker = {};  ///< composes the pose

  /// Starts at the base.
  /// @param twists  with the size that TwistColumns::resize() gives
  TwistWalker(const Columns& free, ChainTwists<S>& twists)
      : columns(free), turn(twists.rotational.data()), shift(twists.translational.data()) {}
  /// Continues in the middle of a chain.
  TwistWalker(const Columns& free, Twist<S>* next_turn, Vector3<S>* next_shift, const Pose<S>& pose)
      : columns(free), turn(next_turn), shift(next_shift) {
    copy_numbers(pose, walker.pose);
  }

  /// Passes a constant transform.
  template <class ConstantPose>
  void fixed(const ConstantPose& transform) {
    walker.fixed(transform);
  }

  /// Passes a frame correction: up to six twists.
  template <class I, class Joint, class U>
  void correct(I i, const Joint& joint, const JointCorrection<U>& correction) {
    if (joint.reversed) walker.correct(i, joint, correction);
    const double sign = joint.reversed ? -1.0 : 1.0;
    const Pose<S>& front = walker.pose;
    const Vector3<S> pivot = front * correction.frame.translation;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      if (columns[i].frame[axis] >= 0) {
        *shift = front.rotation.col(k);
        if (joint.reversed) *shift = -*shift;
        ++shift;
      }
      if (columns[i].frame[axis + 3] >= 0) {
        const Vector3<U> turned = correction.left_jacobian.col(k) * U(sign);
        add_turn(pivot, rotated(front.rotation, turned));
      }
    }
    if (!joint.reversed) walker.correct(i, joint, correction);
  }

  /// Adds a twist for each free parameter of a joint's models, after move().
  /// @param effects  of the parameters: radians or metres per unit
  template <class I, class Joint, class E>
  void move_by_model(I i, const Joint& joint,
                     const E* effects) requires(requires { columns[i].model; }) {
    const Vector3<S> axis = walker.axis(joint);
    for (std::size_t k = 0; k < columns[i].model.size(); ++k) {
      if (columns[i].model[k] < 0) continue;
      const S factor = joint.reversed ? S(-effects[k]) : S(effects[k]);
      const Vector3<S> scaled(axis.x() * factor, axis.y() * factor, axis.z() * factor);
      if (turns(joint.type)) {
        add_turn(walker.pose.translation, scaled);
      } else {
        *shift++ = scaled;
      }
    }
  }
  /// Passes a joint's motion: one twist if its offset is free.
  template <class I, class Joint, class U>
  void move(I i, const Joint& joint, const JointState<U>& motion) {
    walker.move(i, joint, motion);  // a joint's axis is the same before and after it
    if (columns[i].offset < 0) return;
    const double gain = joint.reversed ? -columns[i].gain : columns[i].gain;
    Vector3<S> axis = walker.axis(joint);
    if (gain != 1.0) axis *= S(gain);
    if (turns(joint.type)) {
      add_turn(walker.pose.translation, axis);
    } else {
      *shift++ = axis;
    }
  }

 private:
  /// Writes the twist of a rotation about an axis through a point.
  void add_turn(const Vector3<S>& point, const Vector3<S>& axis) {
    turn->linear = cross(point, axis);
    turn->angular = axis;
    ++turn;
  }
};

/// All twists of a chain, each with its column; translational ones have an angular part of zero.
template <class S>
[[nodiscard]] std::vector<std::pair<int, Twist<S>>> by_column(const ChainTwists<S>& twists,
                                                              const TwistColumns& columns) {
  std::vector<std::pair<int, Twist<S>>> result;
  for (std::size_t i = 0; i < twists.rotational.size(); ++i) {
    result.emplace_back(columns.rotational[i], twists.rotational[i]);
  }
  for (std::size_t i = 0; i < twists.translational.size(); ++i) {
    result.emplace_back(columns.translational[i],
                        Twist<S>{twists.translational[i], Vector3<S>::Zero()});
  }
  return result;
}

}  // namespace kinecal
