// What must hold of a crate's free parameters and priors, each told in a sentence while it is
// compiled: see sentence.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/block_checks.hpp"
#include "kinecal/parameters/free_parameters.hpp"

namespace kinecal::detail {

/// @tparam Found  what LookedUp found
template <class Parameter, class Found, bool kIsKnown = false>
struct JointOfOffset {
  static_assert(
      kIsKnown,
      "kinecal: the robot has no joint of the name in this JointOffset; correct the name");
};
template <class Parameter, bool kJointMoves = false>
struct MotionOfOffset {
  static_assert(kJointMoves,
                "kinecal: the joint in this JointOffset does not move; write FrameOffset instead");
};
template <class Parameter, bool kMovesByItself = false>
struct DriveOfOffset {
  static_assert(
      kMovesByItself,
      "kinecal: the joint in this JointOffset mimics another; free the offset of that one");
};
template <class Parameter, class Found, bool kIsKnown = false>
struct JointOfFrame {
  static_assert(
      kIsKnown,
      "kinecal: the robot has no joint of the name in this FrameOffset; correct the name, "
      "or write VirtualFrame for a frame that is in no URDF");
};
template <class Parameter, bool kIsNoJoint = false>
struct NameOfVirtualFrame {
  static_assert(
      kIsNoJoint,
      "kinecal: this VirtualFrame has the name of a joint of the robot; write FrameOffset "
      "for the joint, or name the frame otherwise");
};
template <class Parameter, class Found, bool kIsKnown = false>
struct CameraOfParameter {
  static_assert(kIsKnown,
                "kinecal: the crate has no camera of the name in this parameter; add the camera or "
                "correct the name");
};
template <class Parameter, bool kSensorHasThem = false>
struct SettingsOfCamera {
  static_assert(
      kSensorHasThem,
      "kinecal: the sensor in this parameter has no such settings; intrinsics are those of "
      "a Camera3d or Camera2d, a depth offset and scaling those of a Camera3d");
};
template <class Parameter, bool kFreesSome = false>
struct AxesOfFrame {
  static_assert(kFreesSome,
                "kinecal: this frame offset frees none of its axes; choose some or leave it out");
};

/// That a free parameter is one of the robot or of a sensor.
template <class P, RobotData R, class Sensors, ParameterKind = P::kKind>
struct CheckParameter;

template <class P, RobotData R, class Sensors>
struct CheckParameter<P, R, Sensors, ParameterKind::joint_offset> {
  using Found = LookedUp<P::kOwner, JointNames<R>>;

  [[nodiscard]] static constexpr JointData joint() {
    if constexpr (Found::kExists) return R::kJoints[joint_index<R>(P::kOwner)];
    return {};
  }
  using type = FirstOf<Unless<Found::kExists, JointOfOffset<P, Found>>,
                       Unless<moves(joint().type), MotionOfOffset<P>>,
                       Unless<!joint().mimic.has_value(), DriveOfOffset<P>>>;
};

template <class P, RobotData R, class Sensors>
struct CheckParameter<P, R, Sensors, ParameterKind::frame_offset> {
  using Found = LookedUp<P::kOwner, JointNames<R>>;
  using type = FirstOf<Unless<Found::kExists, JointOfFrame<P, Found>>,
                       Unless<!P::kIds.empty(), AxesOfFrame<P>>>;
};

template <class P, RobotData R, class Sensors>
struct CheckParameter<P, R, Sensors, ParameterKind::virtual_frame> {
  using type = FirstOf<Unless<joint_index<R>(P::kOwner) == kNowhere, NameOfVirtualFrame<P>>,
                       Unless<!P::kIds.empty(), AxesOfFrame<P>>>;
};

template <class P, class Sensors, bool kHasThem>
struct CheckCamera {
  using Found = LookedUp<P::kOwner, PartNames<Sensors>>;
  using type = FirstOf<Unless<Found::kExists, CameraOfParameter<P, Found>>,
                       Unless<kHasThem, SettingsOfCamera<P>>>;
};
template <class P, RobotData R, class Sensors>
struct CheckParameter<P, R, Sensors, ParameterKind::camera>
    : CheckCamera<P, Sensors, type_of_sensor(P::kOwner, Sensors{}) != SensorType::chain3d> {};
template <class P, RobotData R, class Sensors>
struct CheckParameter<P, R, Sensors, ParameterKind::depth>
    : CheckCamera<P, Sensors, type_of_sensor(P::kOwner, Sensors{}) == SensorType::camera3d> {};

/// True if moving a parameter moves what a sensor observes.
template <class P, class Sensor>
[[nodiscard]] constexpr bool moves_sensor() {
  using Robot = typename Sensor::Chain::Robot;
  constexpr std::string_view owner = P::kOwner;
  if (P::kKind == ParameterKind::camera || P::kKind == ParameterKind::depth) {
    return Sensor::kName == owner;
  }
  if (P::kKind == ParameterKind::virtual_frame) return Sensor::kType == SensorType::chain3d;
  for (std::string_view link = Sensor::Chain::kTip; link != Sensor::Chain::kBase;) {
    const std::size_t joint = joint_above<Robot>(link);
    if (joint == kNowhere) return true;  // the chain is wrong, which is told there
    const bool is_it = P::kKind == ParameterKind::frame_offset
                           ? Robot::kJoints[joint].name == owner
                           : static_drive<Robot>(joint).joint == owner;
    if (is_it) return true;
    link = Robot::kJoints[joint].parent;
  }
  return false;
}

/// True if it moves one of those that a block compares.
template <class P, class Block, class... Sensors>
[[nodiscard]] constexpr bool moves_block(TypeList<Sensors...>) {
  const auto& names = Block::kSensorNames;
  return ((std::find(names.begin(), names.end(), Sensors::kName) != names.end() &&
           moves_sensor<P, Sensors>()) ||
          ...);
}

template <class Parameter, bool kResidualsDepend = false>
struct UseOfParameter {
  static_assert(kResidualsDepend,
                "kinecal: nothing depends on this free parameter; no error block has a sensor that "
                "it moves: leave it out or add such a block");
};

/// The joints and frames that are free, to be looked up.
template <class... Ps>
struct JointsAndFrames {
  [[nodiscard]] static constexpr bool is_one(ParameterKind kind) {
    return kind != ParameterKind::camera && kind != ParameterKind::depth;
  }
  static constexpr auto kNames = [] {
    std::array<std::string_view, (std::size_t(0) + ... + (is_one(Ps::kKind) ? 1 : 0))> names;
    std::size_t n = 0;
    ((is_one(Ps::kKind) ? void(names[n++] = Ps::kOwner) : void()), ...);
    return names;
  }();
};

/// @tparam Found  what LookedUp found
template <class Prior, class Found, bool kIsFree = false>
struct ParameterOfPrior {
  static_assert(kIsFree,
                "kinecal: no joint or frame of the name in this PriorOn is free in the crate; "
                "correct the name or leave it out");
};

/// That a prior is one on a joint or frame that is free.
template <class Prior, class... Ps>
struct CheckPrior {
  using Found = LookedUp<Prior::kOf, JointsAndFrames<Ps...>>;
  using type = Unless<Found::kExists, ParameterOfPrior<Prior, Found>>;
};

}  // namespace kinecal::detail
