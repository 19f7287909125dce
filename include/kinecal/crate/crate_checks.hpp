// What must hold of a crate, each told in a sentence while it is compiled.
//
// A check is a template of its own, so that the compiler names the parameter or the block that it
// is about right before the sentence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate_parts.hpp"
#include "kinecal/crate/type_list.hpp"
#include "kinecal/parameters/free_parameters.hpp"

namespace kinecal::detail {

template <class... Sensors>
[[nodiscard]] constexpr bool has_sensor(std::string_view name, TypeList<Sensors...>) {
  return ((Sensors::kName == name) || ...);
}

template <class... Sensors>
[[nodiscard]] constexpr SensorType type_of_sensor(std::string_view name, TypeList<Sensors...>) {
  SensorType type = SensorType::chain3d;
  (void)((Sensors::kName == name ? (type = Sensors::kType, true) : false) || ...);
  return type;
}

/// True if the names of all parts differ.
template <class... Parts>
[[nodiscard]] constexpr bool have_distinct_names(TypeList<Parts...>) {
  const std::array<std::string_view, sizeof...(Parts)> names = {Parts::kName...};
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (names[i] == names[j]) return false;
    }
  }
  return true;
}

/// That a block can compare its sensors.
template <class P, class Sensors>
struct CheckBlock {
  using B = typename P::Error;
  static_assert(ErrorBlock<B>,
                "kinecal: this error block is not a residual templated on its scalar; write "
                "template <class S> Eigen::Matrix<S, N, 1> operator()(const Vector3<S>& p) const");

  [[nodiscard]] static constexpr bool sensors_exist() {
    for (const std::string_view name : P::kSensorNames) {
      if (!has_sensor(name, Sensors{})) return false;
    }
    return true;
  }
  static_assert(!ErrorBlock<B> || sensors_exist(),
                "kinecal: a sensor of this error block is not in the crate; add it or correct its "
                "name");

  [[nodiscard]] static constexpr bool number_fits() {
    if constexpr (ErrorBlock<B>) return P::kSensorNames.size() == std::size_t(kSensors<B>);
    return true;
  }
  static_assert(
      number_fits(),
      "kinecal: this error block is given too many or too few sensors; one whose residual "
      "takes a point has one sensor, the others two");

  [[nodiscard]] static constexpr bool kinds_fit() {
    if constexpr (ErrorBlock<B>) {
      if (!sensors_exist() || !number_fits()) return true;
      for (std::size_t i = 0; i < P::kSensorNames.size(); ++i) {
        const bool pixels = type_of_sensor(P::kSensorNames[i], Sensors{}) == SensorType::camera2d;
        if (pixels != (SightBlock<B> && i == 1)) return false;
      }
    }
    return true;
  }
  static_assert(kinds_fit(),
                "kinecal: this error block is given a sensor of the wrong kind; a Camera2d stands "
                "second in a block that takes a sight, and nowhere else");
  static constexpr bool kHolds = true;
};

/// That a free parameter is one of the robot or of a sensor.
template <class P, RobotData R, class Sensors>
struct CheckParameter {
  static constexpr std::size_t kJoint = joint_index<R>(P::kOwner);
  static constexpr bool kIsJoint = kJoint != kNowhere;
  static constexpr bool kOfJoint =
      P::kKind == ParameterKind::joint_offset || P::kKind == ParameterKind::frame_offset;
  static constexpr bool kOfCamera =
      P::kKind == ParameterKind::camera || P::kKind == ParameterKind::depth;
  static_assert(
      kIsJoint || P::kKind != ParameterKind::joint_offset,
      "kinecal: the robot has no joint of the name in this JointOffset; correct the name");
  static_assert(
      kIsJoint || P::kKind != ParameterKind::frame_offset,
      "kinecal: the robot has no joint of the name in this FrameOffset; correct the name, "
      "or write VirtualFrame for a frame that is in no URDF");
  static_assert(
      !kIsJoint || P::kKind != ParameterKind::virtual_frame,
      "kinecal: this VirtualFrame has the name of a joint of the robot; write FrameOffset "
      "for the joint, or name the frame otherwise");

  [[nodiscard]] static constexpr bool has_position() {
    if constexpr (kIsJoint) return moves(R::kJoints[kJoint].type);
    return true;
  }
  [[nodiscard]] static constexpr bool mimics() {
    if constexpr (kIsJoint) return R::kJoints[kJoint].mimic.has_value();
    return false;
  }
  static_assert(has_position() || P::kKind != ParameterKind::joint_offset,
                "kinecal: the joint in this JointOffset does not move; write FrameOffset instead");
  static_assert(
      !mimics() || P::kKind != ParameterKind::joint_offset,
      "kinecal: the joint in this JointOffset mimics another; free the offset of that one");
  static_assert(!kOfCamera || has_sensor(P::kOwner, Sensors{}),
                "kinecal: the crate has no camera of the name in this parameter; add the camera or "
                "correct the name");

  [[nodiscard]] static constexpr bool camera_fits() {
    if (!kOfCamera || !has_sensor(P::kOwner, Sensors{})) return true;
    const SensorType type = type_of_sensor(P::kOwner, Sensors{});
    if (P::kKind == ParameterKind::depth) return type == SensorType::camera3d;
    return type != SensorType::chain3d;
  }
  static_assert(
      camera_fits(),
      "kinecal: the sensor in this parameter has no such settings; intrinsics are those of "
      "a Camera3d or Camera2d, a depth offset and scaling those of a Camera3d");
  static constexpr bool kHolds = kOfJoint || kOfCamera || P::kKind == ParameterKind::virtual_frame;
};

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
    if (joint == kNowhere) return false;
    const bool is_it = P::kKind == ParameterKind::frame_offset
                           ? Robot::kJoints[joint].name == owner
                           : static_drive<Robot>(joint).joint == owner;
    if (is_it) return true;
    link = Robot::kJoints[joint].parent;
  }
  return false;
}

/// That some residual depends on a free parameter.
template <class P, class Sensors, class Blocks>
struct CheckDependence;
template <class P, class... Sensors, class... Blocks>
struct CheckDependence<P, TypeList<Sensors...>, TypeList<Blocks...>> {
  [[nodiscard]] static constexpr bool block_depends(
      const std::span<const std::string_view> sensors) {
    for (const std::string_view name : sensors) {
      if (((Sensors::kName == name && moves_sensor<P, Sensors>()) || ...)) return true;
    }
    return false;
  }
  static_assert((block_depends(Blocks::kSensorNames) || ...),
                "kinecal: nothing depends on this free parameter; no error block has a sensor that "
                "it moves: leave it out or add such a block");
  static constexpr bool kHolds = true;
};

}  // namespace kinecal::detail
