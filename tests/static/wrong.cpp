// Wrong lines.  Each gives exactly one error: the sentence after "expect:" above it.  "meant:" is
// the name that the compiler suggests.  run.cmake compares errors and suggestions in order, so each
// sentence is the first and only error of its line.  Compilers say a sentence once for the same
// arguments, and those of constructors after all others.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/errors/plane_to_plane.hpp"
#include "kinecal/errors/point_to_pixel.hpp"
#include "kinecal/errors/point_to_plane.hpp"
#include "kinecal/errors/point_to_point.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/solve/calibrate_crate.hpp"
#include "kinecal/testing/check_block.hpp"
#include "kinecal/testing/check_sensor.hpp"
#include "robots/every_joint.hpp"
#include "robots/fetch_example.hpp"

namespace kinecal {

using Every = every_joint_v2::Robot;
using Fetch = fetch::Robot;
using Arm = Chain3d<"arm", Chain<Fetch, "torso_lift_link", "wrist_roll_link">>;
using OnHead = Chain<Fetch, "torso_lift_link", "head_camera_rgb_optical_frame">;
using Head = Camera3d<"camera", OnHead>;
using Pinhole = Camera2d<"pinhole", OnHead>;
using Finger = Chain3d<"finger", Chain<Every, "upper", "finger \\right\\">>;
using HandEye = Block<"hand_eye", PointToPoint, "camera", "arm">;
using Ground = Block<"ground", PointToPlane, "camera">;

// ---- chains

// expect: the base of this Chain is not a link of the robot; correct its name
// meant: torso_lift_link
Chain<Fetch, "torso_lift_lnk", "wrist_roll_link"> base_not_a_link;

// expect: the tip of this Chain is not a link of the robot; correct its name
// meant: wrist_roll_link
Chain<Fetch, "torso_lift_link", "wrist_roll_joint"> tip_not_a_link;

// expect: a joint of this Chain is floating or planar; chains take fixed, revolute, continuous and
Chain<Every, "base", "float\?\?/ing"> floating_joint;

// expect: the robot has no joint of a name in the Names of this Chain; correct it
// meant: head_pan_joint
Chain<Fetch, "torso_lift_link", "head_pan_link", Names<"haed_pan_joint">> misspelt_frame;

// ---- chains, in crates that are used

// expect: the base of this Chain is not a link of the robot; correct its name
// meant: torso_lift_link
using AtLift = Camera3d<"camera", Chain<Fetch, "torso_lift_ling", "head_pan_link">>;
auto calibrate_misspelt_base() {
  return calibrate(Crate<Arm, AtLift, HandEye>(), {});
}

// expect: the tip of this Chain is not a link of the robot; correct its name
// meant: head_pan_link
using AtPan = Camera3d<"camera", Chain<Fetch, "torso_lift_link", "head_pan_lnk">>;
auto problem_of_misspelt_tip() {
  return Crate<Arm, AtPan, FrameOffset<"head_pan_joint">, HandEye>().problem({});
}

// ---- before the constructors of crates, in which all further checks stand

// expect: this template argument is not a Crate part; parts are sensors, free parameters, Block
Crate<Arm, Head, HandEye, PointToPlane> not_a_part;

// expect: the crate has no part of this name; correct the name
// meant: hand_eye
auto& misspelt_block(Crate<Arm, Head, HandEye>& crate) {
  return crate.block<"hand_ey">();
}

// expect: the crate has no part of this name; correct the name
// meant: hand_eye
void weight_of_misspelt_block(Crate<Arm, Head, HandEye>& crate) {
  crate.block<"hand_eys">().options.scale = 2.0;
}

// expect: this parameter is not free in the crate; add it there or ask for another
// meant: elbow_flex_joint
using Elbow = CrateResult<Crate<Arm, Head, JointOffset<"elbow_flex_joint">, HandEye>>;
auto misspelt_value(const Elbow& result) {
  return result.value<JointOffset<"elbow_flexjoint">>();
}

// expect: this parameter is not free in the crate; add it there or ask for another
using Shift = CrateResult<Crate<Arm, Head, FrameOffset<"head_pan_joint", Axes::xyz>, HandEye>>;
auto value_half_free(const Shift& result) {
  return result.value<FrameOffset<"head_pan_joint">>();
}

// ---- free parameters

// expect: the robot does not have the joint in this JointOffset; correct its name
// meant: elbow_flex_joint
Crate<Arm, Head, JointOffset<"elbow_flx_joint">, HandEye> misspelt_joint_offset;

// expect: the joint in this JointOffset does not move; write FrameOffset instead
Crate<Arm, Head, JointOffset<"head_camera_joint">, HandEye> joint_offset_of_fixed;

// expect: the joint in this JointOffset mimics another; free the offset of that one
Crate<Finger, JointOffset<"finger \\right\\">, Block<"ground", PointToPlane, "finger">>
    joint_offset_of_mimic;

// expect: the robot does not have the joint in this FrameOffset; correct its name, or write
// meant: head_camera_rgb_joint
Crate<Arm, Head, FrameOffset<"head_camera_rgb_jiont">, HandEye> misspelt_frame_offset;

// expect: the robot does not have the joint in this FrameOffset; correct its name, or write
// meant: nothing
Crate<Arm, Head, FrameOffset<"checkerboard">, HandEye> unknown_frame_offset;

// expect: this VirtualFrame has the name of a joint of the robot; write FrameOffset for the joint
Crate<Arm, Head, VirtualFrame<"wrist_roll_joint">, HandEye> virtual_frame_named_as_joint;

// expect: this frame offset does not free any axis; choose axes or leave it out
Crate<Arm, Head, FrameOffset<"head_pan_joint", Axes{}>, HandEye> frame_without_axes;

// expect: a free parameter occurs twice in this Crate; leave one of them out
Crate<Arm, Head, FrameOffset<"head_pan_joint", Axes::xyz>,
      FrameOffset<"head_pan_joint", Axes{.z = true, .c = true}>, HandEye>
    overlapping_axes;

// expect: the crate does not have the sensor or block in this parameter; add it or correct its name
// meant: camera
Crate<Arm, Head, DepthIntrinsics<"camrea">, HandEye> misspelt_camera;

// expect: no joint model that fits the joint has this parameter; parameters/joint_models/joint_model.hpp has their
Crate<Arm, Head, JointModelParameters<"elbow_flex_joint", "gear_ratios">, HandEye> misspelt_model;

// expect: no joint model that fits the joint has this parameter; parameters/joint_models/joint_model.hpp has their
Crate<Arm, Head, JointModelParameters<"torso_lift_joint", "eccentric_sin">, HandEye>
    eccentric_slide;

// expect: the sensor or block in this parameter does not declare it; a Camera3d or Camera2d has
Crate<Arm, Pinhole, DepthIntrinsics<"pinhole">, Block<"pixels", PointToPixel, "arm", "pinhole">>
    depth_of_pinhole_camera;

// expect: the sensor or block in this parameter does not declare it; a Camera3d or Camera2d has
Crate<Arm, Head, CameraIntrinsics<"arm">, HandEye> intrinsics_of_arm;

// expect: no residual depends on this free parameter, because no error block has a sensor that it
Crate<Arm, Head, JointOffset<"torso_lift_joint">, HandEye> above_all_chains;

// expect: no residual depends on this free parameter, because no error block has a sensor that it
Crate<Arm, Head, JointOffset<"elbow_flex_joint">, Ground> moves_unused_sensor;

// expect: the joint, frame or parameter in this PriorOn is not free in the crate; correct its name
// meant: head_pan_joint
Crate<Arm, Head, FrameOffset<"head_pan_joint">, HandEye, PriorOn<"small", "head_pn_joint">>
    misspelt_prior;

// expect: the joint, frame or parameter in this PriorOn is not free in the crate; correct its name
// meant: camera_fx
Crate<Arm, Head, CameraIntrinsics<"camera">, HandEye, PriorOn<"small", "camera_fxx">>
    misspelt_prior_on_an_intrinsic;

// expect: the joint, frame or parameter in this PriorOn is not free in the crate; correct its name
// meant: elbow_flex_joint_gear_ratio
Crate<Arm, Head, JointModelParameters<"elbow_flex_joint", "gear_ratio">, HandEye,
      PriorOn<"small", "elbow_flex_joint_gear_ration">>
    misspelt_prior_on_a_gear;

// ---- error blocks

// expect: a sensor of this error block is not in the crate; add it or correct its name
// meant: camera
Crate<Arm, Head, Block<"hand_eye", PointToPoint, "camra", "arm">> misspelt_sensor;

// expect: a sensor of this error block is not in the crate; add it or correct its name
// meant: nothing
Crate<Arm, HandEye> missing_sensor;

// expect: this error block is not a residual templated on its scalar; write template <class S>
struct Height {
  Eigen::Matrix<double, 1, 1> operator()(const Vector3<double>& p) const {
    return Eigen::Matrix<double, 1, 1>(p.z());
  }
};
Crate<Head, Block<"ground", Height, "camera">> residual_not_templated;

// expect: the residual of this error block is not a vector of fixed size in the scalar of its
struct AnySize {
  template <class S>
  Eigen::Matrix<S, Eigen::Dynamic, 1> operator()(const Vector3<S>& p) const {
    return p;
  }
};
Crate<Head, Block<"ground", AnySize, "camera">> residual_of_any_size;

// expect: the residual of this error block is not a vector of fixed size in the scalar of its
struct OtherScalar {
  template <class S>
  Vector3<double> operator()(const Ray<S>&) const {
    return Vector3<double>::Zero();
  }
};
Crate<Head, Block<"ground", OtherScalar, "camera">> residual_in_double;

// expect: no sensors deliver the arguments of this error block; write template <class S>
struct OfFlags {
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p, bool flag) const {
    return flag ? p : -p;
  }
};
Crate<Head, Block<"ground", OfFlags, "camera">> residual_of_flags;

// expect: no sensors deliver the arguments of this error block, or its last ones do not fit: const
struct TooFewOwn {
  static constexpr std::array kParameters = {ParameterInfo{"a"}, ParameterInfo{"b"}};
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p, const std::array<S, 1>& own) const {
    return p * own[0];
  }
};
Crate<Head, Block<"ground", TooFewOwn, "camera">> parameters_of_another_number;

// expect: the sensor or block in this parameter does not declare it; a Camera3d or Camera2d has
Crate<Head, Block<"ground", PointToPlane, "camera">, BlockParameters<"ground", "height">>
    parameter_that_no_block_has;

// expect: this error block is given too many or too few sensors; it has one for each argument of
Crate<Arm, Head, Block<"ground", PointToPlane, "camera", "arm">> too_many_sensors;

// expect: this error block is given too many or too few sensors; it has one for each argument of
Crate<Arm, Head, Block<"hand_eye", PointToPoint, "camera">> too_few_sensors;

// expect: this error block is given a sensor of the wrong kind, which does not deliver what its
Crate<Arm, Pinhole, Block<"pixels", PointToPixel, "pinhole", "arm">> pinhole_camera_first;

// expect: this error block is given a sensor of the wrong kind, which does not deliver what its
Crate<Arm, Pinhole, Block<"hand_eye", PointToPoint, "arm", "pinhole">> pixels_as_points;

// ---- crates

// expect: this Crate has no sensors; add those of its blocks
Crate<JointOffset<"elbow_flex_joint">, HandEye> no_sensors;

// expect: this Crate has no Block; add what is to be minimized
Crate<Arm, Head, JointOffset<"elbow_flex_joint">> no_blocks;

// expect: the chains of this Crate start at different links or belong to different robots; features
Crate<Arm, Camera3d<"camera", Chain<Fetch, "base_link", "head_pan_link">>, HandEye> different_bases;

// expect: the chains of this Crate start at different links or belong to different robots; features
Crate<Arm, Camera3d<"camera", Chain<Every, "torso", "lower">>, HandEye> different_robots;

// expect: two sensors of this Crate have the same name; rename one of them
Crate<Arm, Head, Chain3d<"camera", OnHead>, HandEye> sensors_of_one_name;

// expect: two blocks of this Crate have the same name; rename one of them
Crate<Arm, Head, HandEye, Block<"hand_eye", PlaneToPlane, "camera", "arm">> blocks_of_one_name;

// expect: two priors of this Crate have the same name; rename one of them
Crate<Arm, Head, JointOffset<"elbow_flex_joint">, JointOffset<"head_pan_joint">, HandEye,
      PriorOn<"small", "elbow_flex_joint">, PriorOn<"small", "head_pan_joint">>
    priors_of_one_name;

// ---- sensors of a user's own

// expect: this sensor has no name; write in it static constexpr std::string_view kType
struct WithoutName {
  template <class S, class Q>
  Vector3<S> place(const Measurement<WithoutName, Q>& m, const std::array<S, 0>&) const {
    return m.point.template cast<S>();
  }
};
Crate<Arm, SensorOn<"camera", OnHead, WithoutName>, HandEye> sensor_without_name;

// expect: place() of this sensor does not return a Vector3<S>, Ray<S>, Pose<S> or Reading<S>
struct PlacesDoubles {
  static constexpr std::string_view kType = "places_doubles";
  template <class S, class Q>
  Vector3<Q> place(const Measurement<PlacesDoubles, Q>& m, const std::array<S, 0>&) const {
    return m.point;
  }
};
Crate<Arm, SensorOn<"camera", OnHead, PlacesDoubles>, HandEye> sensor_in_double;

// expect: this sensor has neither place(measurement, parameters) nor predict(point,
struct WithoutParameters {
  static constexpr std::string_view kType = "without_parameters";
  template <class Q>
  Vector3<Q> place(const Measurement<WithoutParameters, Q>& m) const {
    return m.point;
  }
};
Crate<Arm, SensorOn<"camera", OnHead, WithoutParameters>, HandEye> sensor_without_parameters;

// expect: this error block is given a sensor of the wrong kind, which does not deliver what its
struct Wire {
  static constexpr std::string_view kType = "wire";
  template <class S, class Q>
  Reading<S> place(const Measurement<Wire, Q>& m, const std::array<S, 0>&) const {
    return {.value = S(m.point.x())};
  }
};
Crate<Arm, SensorOn<"camera", OnHead, Wire>, HandEye> reading_as_a_point;

// ---- crates in use: no further error where they are used

// expect: the robot does not have the joint in this JointOffset; correct its name
// meant: elbow_flex_joint
using WithoutJoint = Crate<Arm, Head, JointOffset<"elbow_flex_jiont">, HandEye>;
auto calibrate_misspelt_joint(std::span<const Sample> samples) {
  WithoutJoint crate;
  crate.block<"hand_eye">().options.scale = 2.0;
  (void)make_calibration(crate, samples);
  (void)WithoutJoint::free(crate.table(samples));
  return calibrate(crate, crate.table(samples), samples);
}

// expect: the residual of this error block is not a vector of fixed size in the scalar of its
struct OfAnySize : AnySize {};
auto calibrate_residual_of_any_size() {
  return calibrate(Crate<Arm, Head, Block<"ground", OfAnySize, "camera">>(), {});
}

// expect: no sensors deliver the arguments of this error block; write template <class S>
struct OfAFlag : OfFlags {};
auto table_of_flags() {
  return Crate<Arm, Head, Block<"ground", OfAFlag, "camera">>().table({});
}

// expect: a sensor of this error block is not in the crate; add it or correct its name
// meant: camera
auto problem_of_misspelt_sensor() {
  return Crate<Arm, Head, Block<"hand_eye", PointToPoint, "camer", "arm">>().problem({});
}

// expect: this Crate has no sensors; add those of its blocks
auto calibrate_no_sensors() {
  return calibrate(Crate<FrameOffset<"elbow_flex_joint">, HandEye, Ground>(), {});
}

// expect: this error block is given a sensor of the wrong kind, which does not deliver what its
auto calibrate_pixels_as_points() {
  return calibrate(Crate<Arm, Pinhole, Block<"eye", PointToPoint, "arm", "pinhole">>(), {});
}

// expect: this error block is given too many or too few sensors; it has one for each argument of
auto calibrate_too_few_sensors() {
  return calibrate(Crate<Arm, Head, Block<"far", PointToPoint, "camera">>(), {});
}

// expect: two blocks of this Crate have the same name; rename one of them
auto calibrate_blocks_of_one_name() {
  return calibrate(Crate<Arm, Head, HandEye, Block<"hand_eye", PointToPlane, "camera">>(), {});
}

// expect: the joint, frame or parameter in this PriorOn is not free in the crate; correct its name
// meant: head_pan_joint
auto calibrate_misspelt_prior() {
  return calibrate(
      Crate<Arm, Head, FrameOffset<"head_pan_joint">, HandEye, PriorOn<"p", "head_pan_jont">>(),
      {});
}

// ---- functions, whose bodies come last

// expect: the residual of this error block is not a vector of fixed size in the scalar of its
struct Expression {
  template <class S>
  auto operator()(const Vector3<S>& a, const Vector3<S>& b) const {
    return a - b;
  }
};
void add_expression(Problem& problem) {
  problem.add_block("difference", Expression{}, {"a", "b"});
}

// expect: the residual of this error block is not a vector of fixed size in the scalar of its
struct Numbers {
  template <class S>
  std::array<S, 2> operator()(const PixelObservation<S>& pixel) const {
    return {pixel.predicted.x(), pixel.predicted.y()};
  }
};
void add_numbers(Problem& problem) {
  problem.add_block("pixels", Numbers{}, {"a", "b"});
}

// expect: the residual of this error block is not a vector of fixed size in the scalar of its
struct OneNumber {
  template <class S>
  S operator()(const Pose<S>& pose) const {
    return pose.translation.z();
  }
};
Verdict check_one_number() {
  return check_block(OneNumber{});
}

// expect: this sensor has no name; write in it static constexpr std::string_view kType
struct Nameless {
  template <class S, class Q>
  Vector3<S> place(const Measurement<Nameless, Q>& m, const std::array<S, 0>&) const {
    return m.point.template cast<S>();
  }
};
void add_nameless(Problem& problem) {
  problem.add_sensor(Nameless{}, {"a", "link"});
}

// expect: place() of this sensor does not return a Vector3<S>, Ray<S>, Pose<S> or Reading<S>
struct PlacesExpression {
  static constexpr std::string_view kType = "places_expression";
  template <class S, class Q>
  auto place(const Measurement<PlacesExpression, Q>& m, const std::array<S, 0>&) const {
    return 2.0 * m.point;
  }
};
void add_places_expression(Problem& problem) {
  problem.add_sensor(PlacesExpression{}, {"a", "link"});
}

// expect: predict() of this sensor does not return an Eigen::Matrix<S, 2, 1>
struct PredictsExpression : ChainPoint {
  template <class S, class Q>
  auto predict(const Vector3<S>& p, const std::array<Q, 0>&, const std::array<S, 0>&) const {
    return p.template head<2>() / p.z();
  }
};
void add_predicts_expression(Problem& problem) {
  problem.add_sensor(PredictsExpression{}, {"a", "link"});
}

// expect: this sensor has neither place(measurement, parameters) nor predict(point,
struct DoesNothing {
  static constexpr std::string_view kType = "does_nothing";
};
void add_does_nothing(Problem& problem) {
  problem.add_sensor(DoesNothing{}, {"a", "link"});
}

// expect: place() of this sensor does not return a Vector3<S>, Ray<S>, Pose<S> or Reading<S>
struct PlacesProduct {
  static constexpr std::string_view kType = "places_product";
  static constexpr std::array kParameters = {ParameterInfo{"scale"}};
  template <class S, class Q>
  auto place(const Measurement<PlacesProduct, Q>& m, const std::array<S, 1>& v) const {
    return Vector3<S>(m.point.x(), m.point.y(), m.point.z()) * (1.0 + v[0]);
  }
};
Verdict check_places_product() {
  return check_sensor(PlacesProduct{});
}

// expect: this sensor has no name; write in it static constexpr std::string_view kType
struct Anonymous : DoesNothing {
  static constexpr int kType = 0;
};
auto calibrate_anonymous() {
  return calibrate(Crate<Arm, SensorOn<"camera", OnHead, Anonymous>, HandEye>(), {});
}

// expect: joint positions are not numbers that forward kinematics can use; use double or float, or
auto whole_numbers(const RuntimeChain& arm, const Eigen::VectorXi& q) {
  return forward_kinematics(arm, q);
}

}  // namespace kinecal
