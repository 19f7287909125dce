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

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/pose_walker.hpp"

namespace kinecal {

/// Where the parameters of a joint stand in a vector of parameters (or which columns of a Jacobian
/// are theirs); -1: nowhere.
struct JointIndices {
  int offset = -1;
  double gain = 1.0;  ///< of the offset: the multiplier of a mimic joint
  std::array<int, 6> frame = {-1, -1, -1, -1, -1, -1};  ///< x y z a b c

  bool operator==(const JointIndices&) const = default;
};

/// How one parameter moves all points behind its joint; in the base, per unit of the parameter.
template <class S>
struct Twist {
  Vector3<S> linear, angular;

  [[nodiscard]] Vector3<S> velocity(const Vector3<S>& p_base) const {
    const Vector3<S>&v = linear, &p = p_base;
    const S x = in_register(angular.x()), y = in_register(angular.y()),
            z = in_register(angular.z());
    return {v.x() + y * p.z() - z * p.y(),  // two fused multiply-adds each
            v.y() + z * p.x() - x * p.z(), v.z() + x * p.y() - y * p.x()};
  }
  /// -velocity(p_base), at the same price
  [[nodiscard]] Vector3<S> opposite_velocity(const Vector3<S>& p_base) const {
    const Vector3<S>&v = linear, &p = p_base;
    const S x = in_register(angular.x()), y = in_register(angular.y()),
            z = in_register(angular.z());
    return {(z * p.y() - v.x()) - y * p.z(), (x * p.z() - v.y()) - z * p.x(),
            (y * p.x() - v.z()) - x * p.y()};
  }
};

/// The twists of a chain.  Those that only shift move all points alike and are kept apart.
template <class S>
struct ChainTwists {
  std::vector<Twist<S>> turns;
  std::vector<Vector3<S>> shifts;
};

/// A chain's twists, where they are.
template <class S>
struct BodyTwists {
  std::span<const Twist<S>> turns;
  std::span<const Vector3<S>> shifts;

  BodyTwists() = default;
  BodyTwists(std::span<const Twist<S>> those_that_turn, std::span<const Vector3<S>> the_others)
      : turns(those_that_turn), shifts(the_others) {}
  explicit BodyTwists(const ChainTwists<S>& twists) : BodyTwists(twists.turns, twists.shifts) {}

  /// As numbers, 6 or 3 of each.
  [[nodiscard]] const S* turn_numbers() const {
    static_assert(sizeof(Twist<S>) == 6 * sizeof(S));
    return turns.empty() ? nullptr : turns[0].linear.data();
  }
  [[nodiscard]] const S* shift_numbers() const {
    static_assert(sizeof(Vector3<S>) == 3 * sizeof(S));
    return shifts.empty() ? nullptr : shifts[0].data();
  }
};

/// The Jacobian's columns of a chain's twists, in the order in which the walker finds them.
struct TwistColumns {
  std::vector<int> turns, shifts;

  template <class S>
  void resize(ChainTwists<S>& twists) const {
    twists.turns.resize(turns.size());
    twists.shifts.resize(shifts.size());
  }
};

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
      for (std::size_t k = 0; k < 3; ++k) add(result.shifts, columns[i].frame[k]);
      for (std::size_t k = 3; k < 6; ++k) add(result.turns, columns[i].frame[k]);
    };
    if (!joint.reversed) frame();
    if (moves(joint.type)) add(turns(joint.type) ? result.turns : result.shifts, columns[i].offset);
    if (joint.reversed) frame();
  }
  return result;
}

/// Fills the twists of a chain.
/// @tparam Columns  the columns of the free parameters, by joint of the chain; of a chain that the
///                  compiler knows, constants
template <class S, class Columns = std::span<const JointIndices>>
struct TwistWalker {
  Columns columns;
  Twist<S>* turn;     ///< where the next twist goes that turns;
  Vector3<S>* shift;  ///< the next that only shifts
  PoseWalker<S> walker = {};

  /// @param twists  as many as twist_columns() lists
  TwistWalker(const Columns& free, ChainTwists<S>& twists)
      : columns(free), turn(twists.turns.data()), shift(twists.shifts.data()) {}
  /// Goes on in the middle of a chain.
  TwistWalker(const Columns& free, Twist<S>* next_turn, Vector3<S>* next_shift, const Pose<S>& pose)
      : columns(free), turn(next_turn), shift(next_shift), walker{pose} {}

  template <class ConstantPose>
  void fixed(const ConstantPose& transform) {
    walker.fixed(transform);
  }

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

  template <class I, class Joint, class U>
  void move(I i, const Joint& joint, const Motion<U>& motion) {
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
  /// The twist of a turn about an axis through a point.
  void add_turn(const Vector3<S>& point, const Vector3<S>& axis) {
    turn->linear = cross(point, axis);
    turn->angular = axis;
    ++turn;
  }
};

/// All twists of a chain with their columns, those that only shift as twists without a turn.
template <class S>
[[nodiscard]] std::vector<std::pair<int, Twist<S>>> by_column(const ChainTwists<S>& twists,
                                                              const TwistColumns& columns) {
  std::vector<std::pair<int, Twist<S>>> result;
  for (std::size_t i = 0; i < twists.turns.size(); ++i) {
    result.emplace_back(columns.turns[i], twists.turns[i]);
  }
  for (std::size_t i = 0; i < twists.shifts.size(); ++i) {
    result.emplace_back(columns.shifts[i], Twist<S>{twists.shifts[i], Vector3<S>::Zero()});
  }
  return result;
}

}  // namespace kinecal
