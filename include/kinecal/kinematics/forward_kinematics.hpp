// Forward kinematics and the geometric Jacobian of a chain.
//
//   const RuntimeChain arm = make_chain(robot, "base_link", "gripper_link");
//   const Pose<double> base_T_gripper = forward_kinematics(arm, q);
//   Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, q.size());
//   geometric_jacobian(arm, q, jacobian);
//
// q(i) is the position of joint i of the chain, radians or metres, in any Scalar: double, float,
// packet, Jet, ceres::Jet, Eigen::AutoDiffScalar.  joint_names() gives the order.  Each moving joint has its own position, even
// one that mimics another.  A corrected fixed joint is in the chain, but its q(i) is ignored.
// Nothing is allocated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/kinematics/pose_walker.hpp"

namespace kinecal {

namespace detail {

/// A callable: name of a joint -> its position.
template <class F>
concept PositionByName = requires(F& position_of, const std::string& joint) {
  { position_of(joint) } -> std::convertible_to<double>;
};

/// The corrections of a robot that matches its URDF: none.
struct NoCorrections {
  [[nodiscard]] const JointCorrection<double>& operator[](std::size_t) const {
    static const JointCorrection<double> none;
    return none;
  }
};

/// Joint positions as motions; the walk computes sine and cosine where it needs them.
template <class Q>
struct JointStatesAt {
  const Q& q;

  [[nodiscard]] auto operator[](std::size_t i) const {
    return make_joint_state(typename Q::Scalar(q(static_cast<Eigen::Index>(i))));
  }
};

/// A Walker: also notes the axis of each joint and a point on it, as columns of the Jacobian.
template <class S, class J>
struct JacobianWalker : PoseWalker<S> {
  J& jacobian;

  explicit JacobianWalker(J& out) : jacobian(out) {}

  template <class I, class Joint, class U>
  void move(I i, const Joint& joint, const JointState<U>& motion) {
    PoseWalker<S>::move(i, joint, motion);  // a joint's axis is the same before and after it
    Vector3<S> axis = this->axis(joint);
    if (joint.reversed) axis = -axis;
    const auto column = static_cast<Eigen::Index>(std::size_t(i));
    const Vector3<S>& point = this->pose.translation;
    const bool rotates = turns(joint.type);
    for (Eigen::Index k = 0; k < 3; ++k) {
      jacobian(k, column) = rotates ? point(k) : axis(k);
      jacobian(k + 3, column) = rotates ? axis(k) : S(0.0);
    }
  }
};

template <class S>
constexpr void check_scalar() {
  static_assert(Scalar<S>,
                "kinecal: joint positions are not numbers that forward kinematics can use; use "
                "double or float, or a type with + - *, also with double, and sin and cos beside "
                "it (geometry/scalar.hpp)");
}

/// @throws std::invalid_argument  if `size` is not the number of a chain's joints
template <class Chain>
void check_size(const Chain& chain, Eigen::Index size, const char* what) {
  if (static_cast<std::size_t>(size) == joints_of(chain).size()) return;
  throw std::invalid_argument(std::string(what) + " of size " + std::to_string(size) +
                              " for a chain of " + std::to_string(joints_of(chain).size()) +
                              " joints");
}

}  // namespace detail

/// Names of a chain's joints from base to tip: the order of joint positions.
template <class Chain>
[[nodiscard]] std::vector<std::string> joint_names(const Chain& chain) {
  std::vector<std::string> names;
  for (const auto& joint : joints_of(chain)) names.emplace_back(joint.name);
  return names;
}

/// Forward kinematics: base_T_tip of a chain.
/// @param chain        a RuntimeChain or a Chain
/// @param q            (joints of the chain) positions, radians or metres; any Scalar
/// @param corrections  JointCorrection of each joint of the chain, by index
/// @throws std::invalid_argument  if q has another size
template <class Chain, class Derived, class Corrected = detail::NoCorrections>
[[nodiscard]] Pose<typename Derived::Scalar> forward_kinematics(const Chain& chain,
                                                                const Eigen::MatrixBase<Derived>& q,
                                                                const Corrected& corrections = {}) {
  detail::check_scalar<typename Derived::Scalar>();
  detail::check_size(chain, q.size(), "joint positions");
  PoseWalker<typename Derived::Scalar> walker;
  walk(chain, detail::JointStatesAt<Derived>{q.derived()}, corrections, walker);
  return walker.pose;
}

/// The geometric Jacobian of the tip: how its origin moves and how it rotates, in the base.
/// @param q         (joints of the chain) positions, radians or metres; any Scalar
/// @param jacobian  out (6 x joints): linear velocity of the tip's origin, metres per radian or
///                  metre; then angular velocity.  Columns of fixed joints are zero.
/// @returns         base_T_tip
/// @throws std::invalid_argument  if q or the Jacobian has another size
/// Source: Siciliano et al., Robotics: Modelling, Planning and Control, 3.1.
template <class Chain, class Derived, class J>
Pose<typename Derived::Scalar> geometric_jacobian(const Chain& chain,
                                                  const Eigen::MatrixBase<Derived>& q,
                                                  J&& jacobian) {
  using S = typename Derived::Scalar;
  detail::check_scalar<S>();
  detail::check_size(chain, q.size(), "joint positions");
  detail::check_size(chain, jacobian.cols(), "columns of a Jacobian");
  detail::JacobianWalker<S, std::remove_reference_t<J>> walker(jacobian);
  jacobian.setZero();
  walk(chain, detail::JointStatesAt<Derived>{q.derived()}, detail::NoCorrections{}, walker);
  const Vector3<S>& tip = walker.pose.translation;
  std::size_t i = 0;
  for (const auto& joint : joints_of(chain)) {
    const auto column = static_cast<Eigen::Index>(i++);
    if (!turns(joint.type)) continue;
    const Vector3<S> point(jacobian(0, column), jacobian(1, column), jacobian(2, column));
    const Vector3<S> axis(jacobian(3, column), jacobian(4, column), jacobian(5, column));
    const Vector3<S> linear = cross(axis, Vector3<S>(tip - point));
    for (Eigen::Index k = 0; k < 3; ++k) jacobian(k, column) = linear(k);
  }
  return walker.pose;
}
/// The same for a chain that the compiler knows.
/// @returns  (6 x joints) as above
template <StaticChain C, class Derived>
[[nodiscard]] auto geometric_jacobian(const C& chain, const Eigen::MatrixBase<Derived>& q) {
  Eigen::Matrix<typename Derived::Scalar, 6, static_cast<int>(C::kSize)> jacobian;
  geometric_jacobian(chain, q, jacobian);
  return jacobian;
}

/// Forward kinematics from positions by name: base_T_tip of a chain.
/// @param position_of  callable: name of a joint -> its measured position, radians or metres; a
///                     mimic joint follows the joint that drives it
/// @param corrections  one per joint of the chain
template <class Chain, class PositionOf, class S>
requires detail::PositionByName<PositionOf>
[[nodiscard]] Pose<S> forward_kinematics(const Chain& chain, PositionOf&& position_of,
                                         const Corrections<S>& corrections) {
  PoseWalker<S> walker;
  walk(chain, measured_joint_states(chain, position_of), corrections, walker);
  return walker.pose;
}
/// The same without corrections.
template <class Chain, class PositionOf>
requires detail::PositionByName<PositionOf>
[[nodiscard]] Pose<double> forward_kinematics(const Chain& chain, PositionOf&& position_of) {
  PoseWalker<double> walker;
  walk(chain, measured_joint_states(chain, position_of), detail::NoCorrections{}, walker);
  return walker.pose;
}

}  // namespace kinecal
