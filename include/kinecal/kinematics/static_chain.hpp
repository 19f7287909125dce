// A chain that the compiler knows: its joints, constants and way are found before anything runs.
//
//   using Arm = Chain<fetch::Robot, "torso_lift_link", "wrist_roll_link">;
//   const Pose<double> tip = forward_kinematics(Arm{}, position_of);
//
// The robot is a RobotData, usually made by kinecal_add_robot() from a URDF.  The walk of such a
// chain is that of a RuntimeChain with every joint in a place of its own in the code: fixed joints
// are folded, origins that do not turn and principal axes cost what they must and no table is read.
// It leads from a link down to one below it; any other two links take a RuntimeChain.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/fixed_string.hpp"
#include "kinecal/kinematics/static_pose.hpp"

namespace kinecal {

namespace detail {

inline constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

/// Index of a joint by name, or kNowhere.
template <RobotData R>
[[nodiscard]] constexpr std::size_t joint_index(std::string_view name) {
  for (std::size_t i = 0; i < R::kJoints.size(); ++i) {
    if (R::kJoints[i].name == name) return i;
  }
  return kNowhere;
}

/// Index of the joint above a link, or kNowhere.
template <RobotData R>
[[nodiscard]] constexpr std::size_t joint_above(std::string_view link) {
  for (std::size_t i = 0; i < R::kJoints.size(); ++i) {
    if (R::kJoints[i].child == link) return i;
  }
  return kNowhere;
}

template <RobotData R>
[[nodiscard]] constexpr bool has_link(std::string_view link) {
  return joint_above<R>(link) != kNowhere || R::kJoints[0].parent == link;
}

/// Number of joints from `base` down to `tip`; kNowhere if it is not below.
template <RobotData R>
[[nodiscard]] constexpr std::size_t depth_below(std::string_view base, std::string_view tip) {
  std::size_t depth = 0;
  for (; tip != base; ++depth) {
    const std::size_t joint = joint_above<R>(tip);
    if (joint == kNowhere) return kNowhere;
    tip = R::kJoints[joint].parent;
  }
  return depth;
}

/// The joints from `base` down to `tip`, in this order.
template <RobotData R, std::size_t Depth>
[[nodiscard]] constexpr std::array<std::size_t, Depth> way_down(std::string_view tip) {
  std::array<std::size_t, Depth> way{};
  for (std::size_t i = Depth; i-- > 0;) {
    way[i] = joint_above<R>(tip);
    tip = R::kJoints[way[i]].parent;
  }
  return way;
}

/// The joint whose position moves it, with the law of all mimics on the way: see drive().
template <RobotData R>
[[nodiscard]] constexpr MimicData static_drive(std::size_t joint) {
  MimicData result{R::kJoints[joint].name, 1.0, 0.0};
  for (std::size_t n = 0; R::kJoints[joint].mimic && n < R::kJoints.size(); ++n) {
    const MimicData& mimic = *R::kJoints[joint].mimic;
    result = {mimic.joint, result.multiplier * mimic.multiplier,
              result.multiplier * mimic.offset + result.offset};
    joint = joint_index<R>(mimic.joint);
  }
  return result;
}

/// A unit vector as plain numbers.
struct StaticAxis {
  std::array<double, 3> numbers = {};

  [[nodiscard]] constexpr double operator()(int i) const {
    return numbers[static_cast<std::size_t>(i)];
  }
  operator Vector3<double>() const { return {numbers[0], numbers[1], numbers[2]}; }  // NOLINT
  [[nodiscard]] constexpr int principal() const {
    for (int i = 0; i < 3; ++i) {
      const double a = (*this)((i + 1) % 3), b = (*this)((i + 2) % 3), c = (*this)(i);
      if (a == 0.0 && b == 0.0 && (c == 1.0 || c == -1.0)) return i;
    }
    return -1;
  }
};

/// What a Chain keeps of a joint.
struct StaticJointData {
  std::string_view name;
  JointType type = JointType::fixed;
  PoseData fixed;  ///< constant transform from the previous joint (or the base) to this one
  StaticAxis axis;
  bool corrected = false;
  MimicData drive;
};

/// The pose in front of joint I of a chain, or behind its last one.
template <class C, std::size_t I>
struct FixedOf {
  static constexpr PoseData kPose = I < C::kSize ? C::kJoints[I].fixed : C::kTail;
};

/// Joint I of a chain, as walkers see a ChainJoint.
template <class C, std::size_t I>
struct StaticJoint {
  static constexpr JointType type = C::kJoints[I].type;
  static constexpr StaticAxis axis = C::kJoints[I].axis;
  static constexpr int principal = axis.principal();
  static constexpr bool corrected = C::kJoints[I].corrected, reversed = false;
  static constexpr FixedOf<C, I> fixed = {};
};

}  // namespace detail

/// @tparam R        the robot
/// @tparam Base     the link at which it starts
/// @tparam Tip      the link at which it ends, below the base
/// @tparam Frames   Names of the joints with a frame correction
/// @tparam Virtual  a frame beyond the tip that is in no URDF (a checkerboard): see
///                  with_virtual_frame(); "" for none
template <RobotData R, FixedString Base, FixedString Tip, class Frames = Names<>,
          FixedString Virtual = "">
struct Chain {
  using Robot = R;
  static constexpr std::string_view kBase = Base, kTip = Tip, kVirtual = Virtual;

  static_assert(detail::has_link<R>(Base),
                "kinecal: the base of this Chain is not a link of the robot; correct its name");
  static_assert(!detail::has_link<R>(Base) || detail::has_link<R>(Tip),
                "kinecal: the tip of this Chain is not a link of the robot; correct its name");
  static constexpr std::size_t kDepth =
      detail::has_link<R>(Base) ? detail::depth_below<R>(Base, Tip) : detail::kNowhere;
  static_assert(!detail::has_link<R>(Base) || !detail::has_link<R>(Tip) ||
                    kDepth != detail::kNowhere,
                "kinecal: the tip of this Chain is not below its base; start at a link above both "
                "or use make_chain(), which leads between any two links");

 private:
  static constexpr bool kExists = kDepth != detail::kNowhere;
  static constexpr std::array kWay = detail::way_down < R, kExists ? kDepth : 0 > (Tip);

  [[nodiscard]] static constexpr bool is_kept(const JointData& joint) {
    return moves(joint.type) || Frames::contains(joint.name);
  }
  [[nodiscard]] static constexpr std::size_t count() {
    std::size_t n = kVirtual.empty() ? 0 : 1;
    for (const std::size_t i : kWay) n += is_kept(R::kJoints[i]) ? 1 : 0;
    return n;
  }
  [[nodiscard]] static constexpr bool has_joints_that_do_not_turn_or_slide() {
    for (const std::size_t i : kWay) {
      const JointType type = R::kJoints[i].type;
      if (type == JointType::floating || type == JointType::planar) return true;
    }
    return false;
  }
  static_assert(!has_joints_that_do_not_turn_or_slide(),
                "kinecal: a joint of this Chain is floating or planar; chains take fixed, "
                "revolute, continuous and prismatic joints");

 public:
  static constexpr std::size_t kSize = count();

 private:
  struct Folding {
    std::array<detail::StaticJointData, kSize> joints;
    PoseData tail;
  };
  [[nodiscard]] static constexpr Folding fold() {
    Folding result{};
    PoseData fixed;
    std::size_t n = 0;
    for (const std::size_t i : kWay) {
      const JointData& joint = R::kJoints[i];
      fixed = fixed * joint.origin;
      if (!is_kept(joint)) continue;
      result.joints[n++] = {joint.name,
                            joint.type,
                            fixed,
                            {joint.axis},
                            Frames::contains(joint.name),
                            detail::static_drive<R>(i)};
      fixed = {};
    }
    if (!kVirtual.empty()) {
      result.joints[n] = {kVirtual, JointType::fixed,    fixed, {{1.0, 0.0, 0.0}},
                          true,     {kVirtual, 1.0, 0.0}};
      fixed = {};
    }
    result.tail = fixed;
    return result;
  }
  static constexpr Folding kFolding = fold();

 public:
  static constexpr const std::array<detail::StaticJointData, kSize>& kJoints = kFolding.joints;
  static constexpr const PoseData& kTail = kFolding.tail;
  /// The first joint that moves; kSize if none does.
  static constexpr std::size_t kFirstMotion = [] {
    std::size_t i = 0;
    while (i < kSize && !moves(kFolding.joints[i].type)) ++i;
    return i;
  }();
};

namespace detail {

/// The same chain with corrections of the frames given, and a virtual frame beyond it.
/// @tparam FrameNames    anything with contains(name)
/// @tparam VirtualFrame  a type with kName, or void
template <class C, class FrameNames, class VirtualFrame>
struct Corrected;
template <RobotData R, FixedString Base, FixedString Tip, class Frames, FixedString Virtual,
          class FrameNames>
struct Corrected<Chain<R, Base, Tip, Frames, Virtual>, FrameNames, void> {
  using type = Chain<R, Base, Tip, FrameNames, Virtual>;
};
template <RobotData R, FixedString Base, FixedString Tip, class Frames, FixedString Virtual,
          class FrameNames, class VirtualFrame>
struct Corrected<Chain<R, Base, Tip, Frames, Virtual>, FrameNames, VirtualFrame> {
  using type = Chain<R, Base, Tip, FrameNames, VirtualFrame::kName>;
};
template <class C, class FrameNames, class VirtualFrame = void>
using CorrectedChain = typename Corrected<C, FrameNames, VirtualFrame>::type;

}  // namespace detail

template <class C>
concept StaticChain = requires {
  { C::kFirstMotion } -> std::convertible_to<std::size_t>;
  C::kJoints;
  C::kTail;
};

}  // namespace kinecal
