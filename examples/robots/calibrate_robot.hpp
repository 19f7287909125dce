// The program of a robot; it needs only a crate and a URDF.
//
//   int main(int argc, char** argv) {
//     return calibrate_robot(fetch::Fetch(), "fetch/fetch.urdf", argc, argv);
//   }
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate.hpp"
#include "kinecal/procedure/calibrate_crate.hpp"
#include "robot_example.hpp"

namespace kinecal::examples {

template <SensorPart S>
[[nodiscard]] ExampleSensor describe_sensor() {
  ExampleSensor example{.mount = S::mount(), .type = S::Model::kType};
  if constexpr (requires { S::kTarget; }) example.target = S::kTarget;
  if constexpr (requires { S::kMeasuring; }) example.measuring = S::kMeasuring;
  example.moves = S::Chain::kFirstMotion < S::Chain::kSize;
  return example;
}

/// The plane whose points have a residual of zero, from the residuals of four points.
template <PointBlock B>
[[nodiscard]] ExamplePlane plane_of(const B& block) {
  static_assert(
      kResiduals<B> == 1,
      "kinecal: the simulation knows blocks of two sensors and planes; this block has one "
      "sensor and is not a plane: give the program your own --samples");
  const auto residual = [&](const Vector3<double>& p) { return block(p)(0); };
  const double distance = residual(Vector3<double>::Zero());
  Vector3<double> normal;
  for (int i = 0; i < 3; ++i) normal(i) = residual(Vector3<double>::Unit(i)) - distance;
  return {normal / normal.norm(), distance / normal.norm()};
}

template <BlockPart B>
[[nodiscard]] ExampleBlock describe_block() {
  ExampleBlock example{.name = std::string(B::kName)};
  for (const std::string_view sensor : B::kSensorNames) example.sensors.emplace_back(sensor);
  using Error = typename B::Error;
  if constexpr (PointBlock<Error> && kParametersOfBlock<Error> == 0 &&
                kConditionsOfBlock<Error>.empty())
    example.plane = plane_of(B().error);
  return example;
}

/// Runs the program for a crate, with the crate's weights and losses.
/// @param crate  any kinecal::Crate
template <class C>
[[nodiscard]] RobotExample describe(const C& crate, const std::string& urdf) {
  RobotExample example{.urdf = urdf, .robot = C::robot(), .base = C::base()};
  C::Sensors::for_each(
      [&]<class S>(std::type_identity<S>) { example.sensors.push_back(describe_sensor<S>()); });
  C::Blocks::for_each(
      [&]<class B>(std::type_identity<B>) { example.blocks.push_back(describe_block<B>()); });
  C::Parameters::for_each([&]<class P>(std::type_identity<P>) {
    for (const ParameterId& id : P::kIds) {
      example.free.push_back({id.name(), std::string(id.owner), std::string(id.part)});
    }
    if (P::kKind == ParameterKind::virtual_frame) example.virtual_frame = P::kOwner;
    if (is_frame(P::kKind)) example.frames.emplace(P::kOwner);
  });
  example.problem = [crate](std::span<const Sample> samples) {
    return std::make_unique<Problem>(crate.problem(crate.table(samples)));
  };
  example.free_set = &C::free;
  example.calibrate = [crate](std::span<const Sample> samples, const std::string& urdf_text) {
    return calibrate_and_judge(crate, samples, {}, urdf_text);
  };
  return example;
}

template <class C>
requires requires {
  typename C::Blocks;
}
[[nodiscard]] int calibrate_robot(const C& crate, const std::string& urdf, int argc, char** argv) {
  return calibrate_robot(describe(crate, urdf), argc, argv);
}

}  // namespace kinecal::examples
