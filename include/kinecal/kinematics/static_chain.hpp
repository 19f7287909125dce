// A compile-time chain: the compiler finds its joints and constants.
//
//   using Arm = Chain<fetch::Robot, "torso_lift_link", "wrist_roll_link">;
//   const Pose<double> tip = forward_kinematics(Arm{}, position_of);
//
// The robot is a RobotData, usually generated from a URDF by kinecal_add_robot().  Base and tip are
// any two links.  It walks like a RuntimeChain, but unrolled: each joint has its own code, fixed
// joints are folded, identity rotations and principal axes are free, and no table is read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/chain_checks.hpp"
#include "kinecal/kinematics/chain_fold.hpp"
#include "kinecal/kinematics/static_pose.hpp"
#include "kinecal/kinematics/static_robot.hpp"

namespace kinecal {

namespace detail {

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

/// A joint of a Chain.
struct StaticJointData {
  std::string_view name;
  JointType type = JointType::fixed;
  PoseData fixed;  ///< constant transform from the previous joint (or the base) to this one
  StaticAxis axis;
  bool corrected = false;
  bool reversed = false;
  MimicData drive;
};

/// The constant pose before joint I of a chain, or after its last joint.
template <class C, std::size_t I>
struct FixedOf {
  static constexpr PoseData kPose = I < C::kSize ? C::kJoints[I].fixed : C::kTail;
};

/// Joint I of a chain, with the members of a ChainJoint.
template <class C, std::size_t I>
struct StaticJoint {
  // NOLINTBEGIN(readability-identifier-naming): they are called as there
  static constexpr JointType type = C::kJoints[I].type;
  static constexpr StaticAxis axis = C::kJoints[I].axis;
  static constexpr int principal = axis.principal();
  static constexpr bool corrected = C::kJoints[I].corrected;
  static constexpr bool reversed = C::kJoints[I].reversed;
  static constexpr FixedOf<C, I> fixed = {};
  static constexpr MimicData drive = C::kJoints[I].drive;
  // NOLINTEND(readability-identifier-naming)
};

}  // namespace detail

/// A chain that the compiler knows.
/// @tparam R        the robot
/// @tparam Base     the link at which it starts
/// @tparam Tip      the link at which it ends
/// @tparam Frames   Names of the joints with a frame correction
/// @tparam Virtual  name of a virtual frame beyond the tip, such as a checkerboard, or "": see
///                  with_virtual_frame()
template <RobotData R, FixedString Base, FixedString Tip, class Frames = Names<>,
          FixedString Virtual = "">
struct Chain {
  using Robot = R;                                       ///< a RobotData
  static constexpr std::string_view kBase = Base;        ///< link
  static constexpr std::string_view kTip = Tip;          ///< link
  static constexpr std::string_view kVirtual = Virtual;  ///< frame beyond the tip, or ""

 private:
  using BaseLink = LookedUp<kBase, detail::LinkNames<R>>;
  using TipLink = LookedUp<kTip, detail::LinkNames<R>>;

 public:
  /// False if base or tip is not a link of the robot; a sentence reports that.
  static constexpr bool kHasLinks = BaseLink::kExists && TipLink::kExists;

 private:
  static constexpr auto kWay = detail::find_way(R::kJoints, kHasLinks ? kBase : kTip, kTip,
                                                std::array<std::size_t, 2 * R::kJoints.size()>{});

  [[nodiscard]] static constexpr PoseData fold(auto&& visit) {
    return detail::fold(
        R::kJoints, kWay, [](std::string_view name) { return Frames::contains(name); }, visit);
  }
  [[nodiscard]] static constexpr std::size_t count() {
    std::size_t n = kVirtual.empty() ? 0 : 1;
    (void)fold([&n](const auto&...) { ++n; });
    return n;
  }

 public:
  static constexpr std::size_t kSize = count();  ///< number of joints that move or are corrected

 private:
  struct Folding {
    std::array<detail::StaticJointData, kSize> joints;
    PoseData tail;
  };
  [[nodiscard]] static constexpr Folding folding() {
    Folding result{};
    std::size_t n = 0;
    result.tail =
        fold([&](const JointData& joint, const PoseData& fixed, bool corrected, bool reversed) {
          result.joints[n++] = {joint.name,
                                joint.type,
                                fixed,
                                {joint.axis},
                                corrected,
                                reversed,
                                detail::drive_of(R::kJoints, joint)};
        });
    if (!kVirtual.empty()) {
      result.joints[n] = {kVirtual, JointType::fixed,    result.tail, {{1.0, 0.0, 0.0}}, true,
                          false,    {kVirtual, 1.0, 0.0}};
      result.tail = {};
    }
    return result;
  }
  static constexpr Folding kFolding = folding();

 public:
  /// The joints that move or are corrected, from base to tip.
  static constexpr const std::array<detail::StaticJointData, kSize>& kJoints = kFolding.joints;
  /// Constant transform from the last of them to the tip.
  static constexpr const PoseData& kTail = kFolding.tail;
  /// Indices in the robot of all joints between base and tip.
  static constexpr std::span<const std::size_t> kPassed{kWay.joints.data(), kWay.size};
  /// Index of the first joint that moves; kSize if all are fixed.
  static constexpr std::size_t kFirstMotion = [] {
    std::size_t i = 0;
    while (i < kSize && !moves(kFolding.joints[i].type)) ++i;
    return i;
  }();

 private:
  static constexpr bool kTurnOrSlide =
      std::all_of(kPassed.begin(), kPassed.end(),
                  [](std::size_t joint) { return detail::is_passable(R::kJoints[joint].type); });
  static constexpr detail::FirstOf<
      detail::Unless<BaseLink::kExists, detail::BaseOfChain<Base, BaseLink>>,
      detail::Unless<TipLink::kExists, detail::TipOfChain<Tip, TipLink>>,
      detail::Unless<kTurnOrSlide, detail::JointsOfChain<Base, Tip>>,
      typename detail::CheckFrames<R, Frames>::type>
      kCheck = {};
};

namespace detail {

/// The same chain with corrections of the given frames, and with a virtual frame beyond it.
/// @tparam FrameNames    a type with contains(name)
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

/// A chain that the compiler knows.
template <class C>
concept StaticChain = requires {
  { C::kFirstMotion } -> std::convertible_to<std::size_t>;
  C::kJoints;
  C::kTail;
};

}  // namespace kinecal
