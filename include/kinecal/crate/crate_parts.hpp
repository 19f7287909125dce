// What a crate is made of, besides free parameters: sensors and error blocks as types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/term.hpp"
#include "kinecal/errors/prior.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// A sensor at the tip of a chain.
template <FixedString Name, StaticChain C, SensorType Type>
struct SensorOn {
  using Chain = C;
  static constexpr std::string_view kName = Name;
  static constexpr SensorType kType = Type;

  [[nodiscard]] static Sensor sensor() {
    return {std::string(kName), kType, std::string(C::kTip), ""};
  }
};

/// Points at known places of the chain's tip.
template <FixedString Name, StaticChain C>
struct Chain3d : SensorOn<Name, C, SensorType::chain3d> {};
/// A depth camera; its optical frame is the chain's tip.
template <FixedString Name, StaticChain C>
struct Camera3d : SensorOn<Name, C, SensorType::camera3d> {};
/// A pinhole camera; its optical frame is the chain's tip.
template <FixedString Name, StaticChain C>
struct Camera2d : SensorOn<Name, C, SensorType::camera2d> {};

/// An error block between sensors, named, with its weight and loss; both may be set later:
///
///   crate.block<"hand_eye">().options.loss = {LossType::huber, 0.01};
///
/// @tparam B        the block: one of errors/, or a struct of your own
/// @tparam Sensors  names of the sensors that it compares
template <FixedString Name, class B, FixedString... Sensors>
struct Block {
  using Plain = Block;  ///< also of what is derived from it to set its options
  using Error = B;
  static constexpr std::string_view kName = Name;
  static constexpr std::array<std::string_view, sizeof...(Sensors)> kSensorNames = {Sensors...};

  B error = {};
  TermOptions options = default_options();

 private:
  [[nodiscard]] static TermOptions default_options() {
    TermOptions options;
    if constexpr (requires { B::kType; }) options.type = B::kType;
    if constexpr (requires { B::kUnit; }) options.unit = B::kUnit;
    return options;
  }
};

/// A prior on a joint's offset or a frame's correction: see Prior.
template <FixedString Name, FixedString Of>
struct PriorOn {
  static constexpr std::string_view kName = Name, kOf = Of;

  double joint_scale = 1.0, position_scale = 1.0, rotation_scale = 1.0;
  TermOptions options = {.type = "outrageous", .unit = "1"};
};

template <class P>
concept SensorPart = requires {
  typename P::Chain;
  { P::kType } -> std::convertible_to<SensorType>;
};
template <class P>
concept BlockPart = requires {
  typename P::Error;
  P::kSensorNames;
};
template <class P>
concept PriorPart = requires {
  P::kOf;
};

}  // namespace kinecal
