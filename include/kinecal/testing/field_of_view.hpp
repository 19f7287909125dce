// Points all around a camera, to check what it predicts beyond the middle of its image.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "kinecal/testing/sensor_input.hpp"

namespace kinecal::detail {

/// True if a camera sees the point of an input: sees() is true, or without it the pixel is a finite number.
template <Sensor M>
[[nodiscard]] bool is_seen(const M& sensor, const SensorInput<M, double>& input) {
  if constexpr (HasFieldOfView<M>) return sensor.sees(input.point);
  return input.pixel(sensor).allFinite();
}

/// An input with another point.
/// @param point  (3) metres, in the camera's frame
template <Sensor M>
[[nodiscard]] SensorInput<M, double> at_point(SensorInput<M, double> input,
                                              const Vector3<double>& point) {
  input.point = point;
  return input;
}

/// Inputs with the points that a camera sees: one on its axis, the others 0.5 to 2 m away, at all angles from the
/// axis.
/// @param inputs  their measurements and parameters
template <Sensor M>
[[nodiscard]] std::vector<SensorInput<M, double>> seen_around(
    const M& sensor, std::span<const SensorInput<M, double>> inputs) {
  RandomInput random;
  std::vector<SensorInput<M, double>> all;
  const auto add = [&](std::size_t n, double angle) {
    const double turn = random(-1.0, 1.0) * std::numbers::pi, distance = random(0.5, 2.0);
    const Vector3<double> direction(std::sin(angle) * std::cos(turn),
                                    std::sin(angle) * std::sin(turn), std::cos(angle));
    const auto input = at_point<M>(inputs[n], distance * direction);
    if (is_seen(sensor, input)) all.push_back(input);
  };
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    if (n == 0) add(n, 0.0);
    add(n, (double(n) + random(0.1, 0.9)) * std::numbers::pi / double(inputs.size()));
  }
  return all;
}

/// Checks which points a camera sees: if no sees() says so, predict() does.
template <Sensor M>
[[nodiscard]] Verdict check_field_of_view(const std::string& whose, const M& sensor,
                                          std::span<const SensorInput<M, double>> inputs) {
  if constexpr (!HasFieldOfView<M>) {
    for (const SensorInput<M, double>& input : inputs) {
      const Vector3<double> p = input.point, axis(0.0, 0.0, p.z());
      constexpr double kBeside = 1e-4;  // of the distance
      const auto beside = [&](double x, double y) {
        return is_seen(sensor,
                       at_point<M>(input, axis + kBeside * p.norm() * Vector3<double>(x, y, 0.0)));
      };
      const auto on_axis = at_point<M>(input, axis);
      if (!is_seen(sensor, on_axis) && beside(1, 0) && beside(-1, 0) && beside(0, 1) &&
          beside(0, -1)) {
        return {whose + "it is not a number on the axis, but is beside it" + on_axis.text()};
      }
      const auto opposite = at_point<M>(input, -p);
      if (!is_seen(sensor, input) || !is_seen(sensor, opposite)) continue;
      const Eigen::Vector2d pixel = input.pixel(sensor);
      if ((opposite.pixel(sensor) - pixel).norm() < 1e-9 * (1.0 + pixel.norm())) {
        return {whose +
                "a point and the opposite one, behind the camera, have the same pixel; state " +
                "which points the camera sees: sees(p)" + input.text()};
      }
    }
  }
  return kLawsHold;
}

}  // namespace kinecal::detail
