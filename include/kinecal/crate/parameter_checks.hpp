// Compile-time checks of a crate's free parameters and priors; each fails with a sentence
// (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate_parts.hpp"
#include "kinecal/kinematics/known_name.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/parameters/joint_parameters.hpp"
#include "kinecal/text/sentence.hpp"

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
                "parameters/joint_models/joint_model.hpp has their names");
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
      "has intrinsics, a Camera3d also has depth offset, scaling and polynomial, others what their "
      "kParameters name");
};
template <class Parameter, bool kFreesSome = false>
struct AxesOfFrame {
  static_assert(kFreesSome,
                "kinecal: this frame offset does not free any axis; choose axes or leave it out");
};

/// True if a sensor or block declares the parameter.
template <class Part>
[[nodiscard]] constexpr bool declares(const ParameterId& id) {
  const auto have_it = [&](const auto& infos) {
    for (const ParameterInfo& info : infos) {
      if (info.name == id.part) return true;
    }
    return false;
  };
  if constexpr (requires { typename Part::Chain; }) {
    if (id.part == kLag.name) return true;
  }
  if constexpr (requires { Part::Model::kParameters; }) return have_it(Part::Model::kParameters);
  if constexpr (requires { Part::Error::kParameters; }) return have_it(Part::Error::kParameters);
  return false;
}
/// True if the owner of a free parameter declares all of its numbers.
template <class P, class... Owners>
[[nodiscard]] constexpr bool are_declared(TypeList<Owners...>) {
  return std::all_of(P::kIds.begin(), P::kIds.end(), [](const ParameterId& id) {
    return ((Owners::kName == id.owner && declares<Owners>(id)) || ...);
  });
}

/// Checks that the robot, or a sensor or block, has the free parameter.
template <class P, RobotData R, class Sensors, class Blocks, ParameterKind = P::kKind>
struct CheckParameter {
  using Owners = std::conditional_t<P::kKind == ParameterKind::block, Blocks, Sensors>;
  using Found = LookedUp<P::kOwner, Owners>;
  using type = FirstOf<Unless<Found::kExists, OwnerOfParameter<P, Found>>,
                       Unless<are_declared<P>(Owners()), PartsOfParameter<P>>>;
};

template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::joint_offset> {
  using Found = LookedUp<P::kOwner, JointNames<R>>;
  static constexpr JointData kJoint = [] {
    if constexpr (Found::kExists) return R::kJoints[joint_index(R::kJoints, P::kOwner)];
    return JointData();
  }();
  /// True for an offset, and for a parameter of a model that suits the joint.
  [[nodiscard]] static constexpr bool fits(const ParameterId& id) {
    if (P::kKind == ParameterKind::joint_offset) return true;
    const bool is_mimic = kJoint.mimic.has_value();
    if constexpr (requires { typename P::Model; }) {
      return suits_joint<typename P::Model>(kJoint.type, is_mimic);
    }
    return std::apply(
        [&](const auto&... models) {
          return (is_of_model<std::decay_t<decltype(models)>>(id, is_mimic) || ...);
        },
        JointModels{});
  }
  /// True for a joint that moves by itself, or a link, of the robot.
  [[nodiscard]] static constexpr bool is_partner(std::string_view name, ModelPartner kind) {
    for (const JointData& joint : R::kJoints) {
      if (kind == ModelPartner::link && (joint.parent == name || joint.child == name)) return true;
      if (kind == ModelPartner::joint && joint.name == name && name != P::kOwner) {
        return moves(joint.type) && !joint.mimic.has_value();
      }
    }
    return false;
  }
  /// True for a parameter of a model that suits the joint.
  template <class M>
  [[nodiscard]] static constexpr bool is_of_model(const ParameterId& id, bool is_mimic) {
    if (!suits_joint<M>(kJoint.type, is_mimic)) return false;
    for (const ParameterInfo& info : M::kParameters) {
      if (!id.part.starts_with(info.name)) continue;
      const std::string_view rest = id.part.substr(info.name.size());
      if (partner_of<M>() == ModelPartner::none) {
        if (rest.empty()) return true;
      } else if (rest.starts_with('_') && is_partner(rest.substr(1), partner_of<M>())) {
        return true;
      }
    }
    return false;
  }
  using type = FirstOf<
      Unless<Found::kExists, JointOfOffset<P, Found>>,
      Unless<moves(kJoint.type), MotionOfOffset<P>>,
      Unless<P::kKind == ParameterKind::joint_model || !kJoint.mimic.has_value(), DriveOfOffset<P>>,
      Unless<std::all_of(P::kIds.begin(), P::kIds.end(), fits), NameOfModel<P>>>;
};
template <class P, RobotData R, class Sensors, class Blocks>
struct CheckParameter<P, R, Sensors, Blocks, ParameterKind::joint_model>
    : CheckParameter<P, R, Sensors, Blocks, ParameterKind::joint_offset> {};

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

}  // namespace kinecal::detail
