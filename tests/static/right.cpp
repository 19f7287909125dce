// What the compiler knows about chains, free parameters and crates.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/crate/crate.hpp"
#include "kinecal/errors/point_to_plane.hpp"
#include "kinecal/errors/point_to_point.hpp"
#include "robots/every_joint.hpp"
#include "robots/fetch_example.hpp"

namespace kinecal {

using Every = every_joint_v2::Robot;
using Fetch = fetch::Robot;

// ---- chains

using ToGripper = Chain<Fetch, "torso_lift_link", "gripper_link">;
using ToCamera = Chain<Fetch, "torso_lift_link", "head_camera_rgb_optical_frame">;
using ToFinger = Chain<Every, "upper", "finger \\right\\">;
static_assert(StaticChain<ToGripper> && StaticChain<ToCamera> && StaticChain<ToFinger>);

// Fixed joints are folded, unless they are corrected.
static_assert(ToGripper::kSize == 7 && ToGripper::kFirstMotion == 0);
static_assert(Chain<Fetch, "torso_lift_link", "gripper_link", Names<"gripper_axis">>::kSize == 8);
static_assert(Chain<Fetch, "base_link", "gripper_link">::kSize == 8);
static_assert(Chain<Fetch, "base_link", "base_link">::kSize == 0);
static_assert(ToGripper::kTail.translation == std::array{0.16645, 0.0, 0.0});
static_assert(ToGripper::kJoints[6].name == "wrist_roll_joint" && !ToGripper::kJoints[6].corrected);

// What comes before the first motion is the same for all positions.
using Fixed = Chain<Every, "torso", "Kamera \303\274brig">;
using Corrected = Chain<Every, "torso", "Kamera \303\274brig", Names<"Kamera \303\274brig">>;
static_assert(Fixed::kSize == 0 && Fixed::kFirstMotion == 0);
static_assert(Corrected::kSize == 1 && Corrected::kFirstMotion == 1);
using Gripper = Chain<Fetch, "wrist_flex_link", "gripper_link",
                      Names<"wrist_roll_joint", "gripper_axis">, "checkerboard">;
static_assert(Gripper::kSize == 3 && Gripper::kFirstMotion == 0);
static_assert(Gripper::kJoints[2].name == "checkerboard" && Gripper::kJoints[2].corrected);

// Identity rotations, zero translations and principal axes are detected; -0 is 0.
using First = detail::FixedOf<ToCamera, 0>;
static_assert(!detail::kTurns<First> && detail::ConstantColumn<First, 3>::kFirst == 0);
static_assert(detail::kTurns<detail::FixedOf<ToCamera, ToCamera::kSize>>);
using Identity = detail::FixedOf<ToFinger, 1>;
static_assert(!detail::kTurns<Identity> && detail::ConstantColumn<Identity, 3>::kFirst == 3);
static_assert(detail::StaticJoint<ToCamera, 0>::principal == 2);
static_assert(detail::StaticJoint<ToFinger, 0>::principal == -1);

// a * b composes.
constexpr PoseData kQuarterTurn = {.rotation = {0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0},
                                   .translation = {1.0, 2.0, 3.0}};
static_assert((kQuarterTurn * kQuarterTurn).translation == std::array{-1.0, 3.0, 6.0});
static_assert((kQuarterTurn * kQuarterTurn).rotation ==
              std::array{-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0});

// A mimic is driven by another joint.
static_assert(ToFinger::kJoints[1].drive.joint == "finger \"left\"");
static_assert(kColumnsOf<ToFinger, FreeParameters<JointOffset<"finger \"left\"">>>[1].offset == 0);
static_assert(kColumnsOf<ToFinger, FreeParameters<JointOffset<"finger \"left\"">>>[1].gain == -1.1);

// A robot is written in place; its origins may be left out.
[[maybe_unused]] inline Robot lift() {
  return Robot("lift",
               {{.name = "lift", .type = JointType::prismatic, .parent = "base", .child = "top"},
                {"tip", JointType::fixed, "top", "tip", {}}});
}

// ---- names

struct Some {
  static constexpr std::array<std::string_view, 3> kNames = {"elbow", "wrist", "wrists"};
};
static_assert(std::is_same_v<LookedUp<kView<"wrist">, Some>, Known>);
static_assert(std::is_same_v<LookedUp<kView<"Wrsit">, Some>, DidYouMean<'w', 'r', 'i', 's', 't'>>);
static_assert(std::is_same_v<LookedUp<kView<"shoulder">, Some>, DidYouMean<>>);

// ---- free parameters

using Elbow = JointOffset<"elbow_flex_joint">;
using Shift = FrameOffset<"head_pan_joint", Axes::xyz>;
using Turn = FrameOffset<"head_pan_joint", Axes::abc>;
using Board = VirtualFrame<"checkerboard">;
using Lens = CameraIntrinsics<"camera">;
using Depth = DepthCorrection<"camera">;
static_assert(FreeParameter<Elbow> && FreeParameter<Shift> && FreeParameter<Board> &&
              FreeParameter<Lens> && FreeParameter<Depth> && !FreeParameter<PointToPlane>);

// A slot is the number of parameters before it.
using Free = FreeParameters<Elbow, Shift, Board, Lens, Depth, Turn>;
static_assert(Free::kSize == 1 + 3 + 6 + 4 + 2 + 3 && Free::are_distinct());
static_assert(Free::kSlot<Elbow> == 0 && Free::kSlot<Shift> == 1 && Free::kSlot<Board> == 4 &&
              Free::kSlot<Lens> == 10 && Free::kSlot<Depth> == 14 && Free::kSlot<Turn> == 16);
static_assert(FreeParameters<>::kSize == 0 && FreeParameters<>::are_distinct());

// Numbers are found by name, whichever free parameter they belong to.
static_assert(Free::find("elbow_flex_joint", "") == 0 && Free::find("head_pan_joint", "z") == 3 &&
              Free::find("camera", "z_scaling") == 15 && Free::find("head_pan_joint", "c") == 18);
static_assert(Free::find("elbow_flex_joint", "x") == -1 && Free::find("head_pan_joint", "") == -1);
static_assert(Free::have<FrameOffset<"head_pan_joint">>() &&
              Free::have<DepthIntrinsics<"camera">>());
static_assert(!FreeParameters<Shift>::have<FrameOffset<"head_pan_joint">>());
static_assert(Free::kSlot<DepthIntrinsics<"camera">> == 10);

// Names must be distinct, even if owner and part are split differently.
static_assert(!FreeParameters<Elbow, Elbow>::are_distinct());
static_assert(!FreeParameters<Lens, DepthIntrinsics<"camera">>::are_distinct());
static_assert(!FreeParameters<Shift, JointOffset<"head_pan_joint_y">>::are_distinct());
static_assert((Axes::xyz | Axes::abc) == Axes::all);

// Columns of a chain are the slots of its joints.
using Panned = Chain<Fetch, "torso_lift_link", "head_tilt_link", Names<"head_pan_joint">>;
static_assert(kColumnsOf<Panned, Free>[0].frame == std::array{1, 2, 3, 16, 17, 18});
static_assert(kColumnsOf<Panned, Free>[0].offset == -1 && kColumnsOf<Panned, Free>[1].offset == -1);
static_assert(kColumnsOf<ToGripper, Free>[3].offset == 0 &&
              kColumnsOf<ToGripper, Free>[3].gain == 1.0);

// ---- crates

using Arm = Chain3d<"arm", ToGripper>;
using Head = Camera3d<"camera", ToCamera>;
using HandEye = Block<"hand_eye", PointToPoint, "camera", "arm">;
using Ground = Block<"ground", PointToPlane, "camera">;
static_assert(SensorPart<Arm> && SensorPart<Head> && BlockPart<HandEye> && !BlockPart<Arm>);

// Parts may stand in any order; parameters keep theirs.
using Forwards = Crate<Arm, Head, Elbow, Depth, HandEye, Ground>;
using Backwards = Crate<Ground, HandEye, Elbow, Depth, Head, Arm>;
static_assert(std::is_same_v<Forwards::Free, FreeParameters<Elbow, Depth>>);
static_assert(std::is_same_v<Forwards::Free, Backwards::Free>);
static_assert(Backwards::Sensors::kSize == 2 && Backwards::Blocks::kSize == 2);

// A number of a free parameter has a full name.
static_assert(!std::is_constructible_v<ParameterId, const char*, const char*>);

// A crate of crates has the parts of all of them, each once.
using Reach = Crate<Arm, Head, Elbow, HandEye>;
using Look = Crate<Head, Depth, Ground>;
using Both = Crate<Reach, Look, Shift, PriorOn<"small", "head_pan_joint">>;
static_assert(std::is_same_v<Both::Sensors, detail::TypeList<Arm, Head>>);
static_assert(std::is_same_v<Both::Free, FreeParameters<Elbow, Depth, Shift>>);
static_assert(std::is_same_v<Both::Blocks, detail::TypeList<HandEye, Ground>>);
static_assert(Both::Priors::kSize == 1);
static_assert(std::is_same_v<Crate<Both, Reach>::Free, Both::Free>);

[[maybe_unused]] inline const auto& hand_eye_of(Both& crate) {
  return crate.block<"hand_eye">();
}
Both both;
Crate<Both, Look> nested;
Backwards backwards;

}  // namespace kinecal
