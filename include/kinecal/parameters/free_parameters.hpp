// Free parameters as types; the compiler knows their slots (indices).
//
//   JointOffset<"elbow_flex_joint">           one number, added to the measured position
//   FrameOffset<"head_pan_joint">             six: x y z a b c
//   FrameOffset<"head_pan_joint", Axes::xyz>  three of them
//   VirtualFrame<"checkerboard">              six, of a frame that is not in the URDF
//   CameraIntrinsics<"camera">                four: fx fy cx cy
//   DepthCorrection<"camera">                 two: z_offset z_scaling
//   DepthIntrinsics<"camera">                 these six of a depth camera
//   DepthPolynomial<"camera">                 six more: z_quadratic z_x z_y z_xx z_xy z_yy
//   JointModelParameters<"elbow", "gear_ratio">   what a joint model declares
//   OwnJointModel<"elbow", Worm>              all that a joint model of your own declares
//   SensorParameters<"wire", "scale">         what a sensor declares
//   BlockParameters<"sphere", "radius">       what an error block declares
//
// parameter.hpp defines the names of the numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/parameters/joint_models/joint_model.hpp"
#include "kinecal/parameters/parameter.hpp"
#include "kinecal/text/fixed_string.hpp"

namespace kinecal {

/// Axes of a frame correction: x y z of the translation, a b c of the rotation vector.
struct Axes {
  bool x = false;  ///< translation along x
  bool y = false;  ///< translation along y
  bool z = false;  ///< translation along z
  bool a = false;  ///< rotation vector, x component
  bool b = false;  ///< rotation vector, y component
  bool c = false;  ///< rotation vector, z component

  static const Axes all;  ///< all six
  static const Axes xyz;  ///< the translation
  static const Axes abc;  ///< the rotation vector

  /// As a list: x y z a b c.
  [[nodiscard]] constexpr std::array<bool, 6> flags() const { return {x, y, z, a, b, c}; }
  /// The axes of both.
  [[nodiscard]] constexpr Axes operator|(const Axes& o) const {
    return {x || o.x, y || o.y, z || o.z, a || o.a, b || o.b, c || o.c};
  }
  bool operator==(const Axes&) const = default;  ///< the same axes
};
inline constexpr Axes Axes::all = {true, true, true, true, true, true};
inline constexpr Axes Axes::xyz = {true, true, true, false, false, false};
inline constexpr Axes Axes::abc = {false, false, false, true, true, true};

/// One number of a free parameter.
struct ParameterId {
  std::string_view owner;      ///< joint, frame, sensor or block
  std::string_view part;       ///< "x", "fx", ...; "" for a joint's offset
  std::string_view full_name;  ///< as in parameter.hpp: "head_pan_joint_x"

  ParameterId() = default;
  /// Takes all three: an id without its full name does not compile.
  constexpr ParameterId(std::string_view of, std::string_view number,
                        std::string_view name_in_tables)
      : owner(of), part(number), full_name(name_in_tables) {}

  /// The full name, for tables.
  [[nodiscard]] std::string name() const { return std::string(full_name); }
};

/// The kinds of free parameters.
enum class ParameterKind {
  joint_offset,   ///< the position of a joint
  joint_model,    ///< declared by a joint model: a gear ratio
  frame_offset,   ///< the origin of a joint
  virtual_frame,  ///< a frame that is not in the URDF
  sensor,         ///< declared by a sensor: intrinsics, a scale factor
  block           ///< declared by an error block: the unknown length of a bar
};
/// True for the parameters of a frame, which has six.
[[nodiscard]] constexpr bool is_frame(ParameterKind kind) {
  return kind == ParameterKind::frame_offset || kind == ParameterKind::virtual_frame;
}

/// Offset of a joint: one number, radians or metres.
template <FixedString Joint>
struct JointOffset {
  static constexpr ParameterKind kKind = ParameterKind::joint_offset;         ///< what it corrects
  static constexpr std::string_view kOwner = Joint;                           ///< name of the joint
  static constexpr std::array<ParameterId, 1> kIds = {{{Joint, "", Joint}}};  ///< its numbers
};

namespace detail {

template <FixedString Owner, FixedString Part>
inline constexpr ParameterId kId = {Owner, Part, kView<Owner + FixedString("_") + Part>};

/// The name of a parameter of a joint model, with a zero at its end.
template <FixedString Joint, class M, std::size_t I>
inline constexpr auto kNameOfModel = [] {
  constexpr std::string_view kJoint = Joint, kPart = M::kParameters[I].name;
  std::array<char, kJoint.size() + kPart.size() + 2> name{};
  auto end = std::copy(kJoint.begin(), kJoint.end(), name.begin());
  *end++ = '_';
  std::copy(kPart.begin(), kPart.end(), end);
  return name;
}();

/// Some of a frame's six numbers.
template <FixedString F, Axes Chosen>
inline constexpr auto kFrameIds = [] {
  constexpr std::array<bool, 6> kFlags = Chosen.flags();
  constexpr std::array kAll = {kId<F, "x">, kId<F, "y">, kId<F, "z">,
                               kId<F, "a">, kId<F, "b">, kId<F, "c">};
  std::array<ParameterId, std::count(kFlags.begin(), kFlags.end(), true)> ids{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (kFlags[i]) ids[n++] = kAll[i];
  }
  return ids;
}();

}  // namespace detail

/// Correction of a joint's origin: up to six numbers, metres and radians, in the joint's frame.
template <FixedString Joint, Axes Chosen = Axes::all>
struct FrameOffset {
  static constexpr ParameterKind kKind = ParameterKind::frame_offset;  ///< what it corrects
  static constexpr std::string_view kOwner = Joint;                    ///< name of the joint
  static constexpr auto kIds = detail::kFrameIds<Joint, Chosen>;       ///< its numbers
};

/// A frame that is not in the URDF (a checkerboard, a tracker): up to six numbers, metres and
/// radians, in the sensor's frame.
template <FixedString Frame, Axes Chosen = Axes::all>
struct VirtualFrame {
  static constexpr FixedString kName = Frame;                           ///< name of the frame
  static constexpr ParameterKind kKind = ParameterKind::virtual_frame;  ///< what it corrects
  static constexpr std::string_view kOwner = Frame;                     ///< name of the frame
  static constexpr auto kIds = detail::kFrameIds<Frame, Chosen>;        ///< its numbers
};

/// Parameters that their owner declares: a joint model, a sensor or an error block.
/// @tparam Owner  name of the joint, sensor or block
/// @tparam Parts  names of the parameters, as in the owner's kParameters
template <ParameterKind Kind, FixedString Owner, FixedString... Parts>
struct OwnedParameters {
  static constexpr ParameterKind kKind = Kind;       ///< what it corrects
  static constexpr std::string_view kOwner = Owner;  ///< name of the owner
  static constexpr std::array<ParameterId, sizeof...(Parts)> kIds = {
      detail::kId<Owner, Parts>...};  ///< its numbers
};

// Distinct types, not aliases: compilers print these names.

/// Parameters of joint models (parameters/joint_models/joint_model.hpp): "gear_ratio", "eccentric_sin",
/// "coupling_shoulder".
template <FixedString Joint, FixedString... Parts>
struct JointModelParameters : OwnedParameters<ParameterKind::joint_model, Joint, Parts...> {};
/// All parameters of a joint model of your own: OwnJointModel<"elbow", Worm>.
template <FixedString Joint, class M>
struct OwnJointModel {
  static_assert(partner_of<M>() == ModelPartner::none,
                "kinecal: the parameters of this joint model name another joint or a link; write "
                "JointModelParameters with their names instead");
  using Model = M;                                                    ///< the joint model
  static constexpr ParameterKind kKind = ParameterKind::joint_model;  ///< what it corrects
  static constexpr std::string_view kOwner = Joint;                   ///< name of the joint
  static constexpr auto kIds = []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array{
        ParameterId(Joint, M::kParameters[I].name, detail::kNameOfModel<Joint, M, I>.data())...};
  }
  (std::make_index_sequence<M::kParameters.size()>());  ///< its numbers
};
/// Parameters that a sensor declares.
template <FixedString Sensor, FixedString... Parts>
struct SensorParameters : OwnedParameters<ParameterKind::sensor, Sensor, Parts...> {};
/// Parameters that an error block declares.
template <FixedString Block, FixedString... Parts>
struct BlockParameters : OwnedParameters<ParameterKind::block, Block, Parts...> {};

/// Intrinsics of a camera: fx fy cx cy, relative.
template <FixedString Camera>
struct CameraIntrinsics : SensorParameters<Camera, "fx", "fy", "cx", "cy"> {};

/// Depth correction of a depth camera: z_offset (metres) and z_scaling (relative).
template <FixedString Camera>
struct DepthCorrection : SensorParameters<Camera, "z_offset", "z_scaling"> {};

/// How a depth camera bends depth: z_quadratic (1/m), z_x z_y z_xx z_xy z_yy (relative).
template <FixedString Camera>
struct DepthPolynomial
    : SensorParameters<Camera, "z_quadratic", "z_x", "z_y", "z_xx", "z_xy", "z_yy"> {};

/// Intrinsics and depth correction of a depth camera: six numbers.
template <FixedString Camera>
struct DepthIntrinsics : SensorParameters<Camera, "fx", "fy", "cx", "cy", "z_offset", "z_scaling"> {
};

/// A part of a crate that frees numbers.
template <class P>
concept FreeParameter = requires {
  { P::kKind } -> std::convertible_to<ParameterKind>;
  { P::kOwner } -> std::convertible_to<std::string_view>;
  P::kIds[0].owner;
};

/// A list of free parameters.  Slots follow the order of the list.
template <FreeParameter... Ps>
struct FreeParameters {
  /// Number of slots.
  static constexpr std::size_t kSize = (std::size_t(0) + ... + Ps::kIds.size());
  /// The number in each slot.
  static constexpr std::array<ParameterId, kSize> kIds = [] {
    std::array<ParameterId, kSize> ids{};
    std::size_t n = 0;
    [[maybe_unused]] const auto append = [&](const auto& of_parameter) {
      for (const ParameterId& id : of_parameter) ids[n++] = id;
    };
    (append(Ps::kIds), ...);
    return ids;
  }();

  /// The slot of a number, or -1.
  [[nodiscard]] static constexpr int find(std::string_view owner, std::string_view part) {
    for (std::size_t i = 0; i < kSize; ++i) {
      if (kIds[i].owner == owner && kIds[i].part == part) return static_cast<int>(i);
    }
    return -1;
  }

  /// True if all names differ, even where owner and part are split differently.
  [[nodiscard]] static constexpr bool are_distinct() {
    for (std::size_t i = 0; i < kSize; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (kIds[i].full_name == kIds[j].full_name) return false;
      }
    }
    return true;
  }

  /// True if all numbers of a parameter are among these.
  template <FreeParameter P>
  [[nodiscard]] static constexpr bool have() {
    const auto is_one = [](const ParameterId& id) { return find(id.owner, id.part) >= 0; };
    return std::all_of(P::kIds.begin(), P::kIds.end(), is_one);
  }

  /// The owners, for LookedUp.
  static constexpr std::array<std::string_view, sizeof...(Ps)> kNames = {Ps::kOwner...};
  /// True if one of these has this owner.  So a Chain takes free parameters as its list of frames.
  [[nodiscard]] static constexpr bool contains(std::string_view owner) {
    return std::find(kNames.begin(), kNames.end(), owner) != kNames.end();
  }

  /// The slot of the first number of a parameter.
  template <FreeParameter P>
  static constexpr int kSlot = find(P::kIds[0].owner, P::kIds[0].part);
};

/// The slots of each joint's offset and frame in a chain: chain_parameters() at compile time.
/// @tparam C  a Chain
/// @tparam F  a FreeParameters
template <StaticChain C, class F>
inline constexpr std::array<OffsetAndFrame, C::kSize> kColumnsOf = [] {
  std::array<OffsetAndFrame, C::kSize> columns{};
  for (std::size_t i = 0; i < C::kSize; ++i) {
    columns[i] = joint_indices(C::kJoints[i], [](std::string_view owner, std::string_view part) {
      return F::find(owner, part);
    });
  }
  return columns;
}();

}  // namespace kinecal
