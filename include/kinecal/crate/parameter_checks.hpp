// Compile-time checks of a crate's free parameters and priors; each fails with a sentence
// (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/block_checks.hpp"
#include "kinecal/parameters/free_parameters.hpp"

namespace kinecal::detail {

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <class Parameter, class Found, bool kIsKnown = false>
struct JointOfOffset {
  static_assert(kIsKnown,
                "kinecal: the robot does not have the joint in this JointOffset; correct its name");
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
      "kinecal: the robot does not have the joint in this FrameOffset; correct its name, or write "
      "VirtualFrame for a frame that is not in the URDF");
};
template <class Parameter, bool kIsNoJoint = false>
struct NameOfVirtualFrame {
  static_assert(
      kIsNoJoint,
      "kinecal: this VirtualFrame has the name of a joint of the robot; write FrameOffset "
      "for the joint, or rename the frame");
};
template <class Parameter, bool kIsKnown = false>
struct NameOfModel {
  static_assert(kIsKnown,
                "kinecal: no joint model that fits the joint has this parameter; "
                "kinematics/joint_model.hpp has their names");
};
template <class Parameter, class Found, bool kIsKnown = false>
struct OwnerOfParameter {
  static_assert(kIsKnown,
                "kinecal: the crate does not have the sensor or block in this parameter; add it or "
                "correct its name");
};
template <class Parameter, bool kOwnerDeclaresThem = false>
struct PartsOfParameter {
  static_assert(
      kOwnerDeclaresThem,
      "kinecal: the sensor or block in this parameter does not declare it; a Camera3d or Camera2d "
      "has intrinsics, a Camera3d also has depth offset and scaling, others what their "
      "kParameters name");
};
template <class Parameter, bool kFreesSome = false>
struct AxesOfFrame {
  static_assert(kFreesSome,
                "kinecal: this frame offset does not free any axis; choose axes or leave it out");
};

/// Checks that the robot, or a sensor, has the free parameter.
template <class P, RobotData R, class Sensors, class Blocks, ParameterKind = P::kKind>
struct CheckParameter;

template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::joint_offset> {
  using Found = LookedUp<P::kOwner, JointNames<R>>;

  [[nodiscard]] static constexpr JointData joint() {
    if constexpr (Found::kExists) return R::kJoints[joint_index(R::kJoints, P::kOwner)];
    return {};
  }
  using type = FirstOf<Unless<Found::kExists, JointOfOffset<P, Found>>,
                       Unless<moves(joint().type), MotionOfOffset<P>>,
                       Unless<!joint().mimic.has_value(), DriveOfOffset<P>>>;
};

template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::joint_model> {
  using Joint = CheckParameter<P, R, Sensors, Blocks, ParameterKind::joint_offset>;

  [[nodiscard]] static constexpr bool are_known() {
    for (const ParameterId& id : P::kIds) {
      bool found = false;
      for (std::size_t k = 0; k < kJointModelSize; ++k) {
        const bool fits = turns(Joint::joint().type) || !kJointModelRotatesOnly[k];
        found |= kJointModelNames[k] == id.part && fits;
      }
      if (!found) return false;
    }
    return true;
  }
  using type = FirstOf<typename Joint::type, Unless<are_known(), NameOfModel<P>>>;
};

template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::frame_offset> {
  using Found = LookedUp<P::kOwner, JointNames<R>>;
  using type = FirstOf<Unless<Found::kExists, JointOfFrame<P, Found>>,
                       Unless<!P::kIds.empty(), AxesOfFrame<P>>>;
};

template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::virtual_frame> {
  using type =
      FirstOf<Unless<joint_index(R::kJoints, P::kOwner) == kNowhere, NameOfVirtualFrame<P>>,
              Unless<!P::kIds.empty(), AxesOfFrame<P>>>;
};

/// The parameters that a sensor or block declares.
template <class M>
[[nodiscard]] constexpr auto declared_parameters() {
  if constexpr (requires { M::kParameters; }) {
    return M::kParameters;
  } else {
    return std::array<ParameterInfo, 0>{};
  }
}
/// True if the owner of a parameter declares all of its parts.
template <class P, class Part, class M>
[[nodiscard]] constexpr bool declares() {
  if (Part::kName != P::kOwner) return false;
  for (const ParameterId& id : P::kIds) {
    bool found = false;
    for (const ParameterInfo& info : declared_parameters<M>()) found |= info.name == id.part;
    if (!found) return false;
  }
  return true;
}
template <class P, class... Parts>
[[nodiscard]] constexpr bool one_declares(TypeList<Parts...>) {
  if constexpr (P::kKind == ParameterKind::block) {
    return (declares<P, Parts, typename Parts::Error>() || ...);
  } else {
    return (declares<P, Parts, typename Parts::Model>() || ...);
  }
}
/// @tparam Owners  sensors or blocks
template <class P, class Owners>
struct CheckOwn {
  using Found = LookedUp<P::kOwner, PartNames<Owners>>;
  using type = FirstOf<Unless<Found::kExists, OwnerOfParameter<P, Found>>,
                       Unless<one_declares<P>(Owners{}), PartsOfParameter<P>>>;
};
template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::sensor> : CheckOwn<P, Sensors> {};
template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::block> : CheckOwn<P, Blocks> {};

}  // namespace kinecal::detail
