// Noise of measurements in studies: each measured number has a standard deviation along a
// direction.
//
//   pixel      (u, v) of cameras, each; also of depth cameras, across the ray
//   depth      of depth cameras, along the ray: depth z^2, metres
//   point      of everything else, each coordinate; rotation of its orientation
//   joint      of each joint position: encoder, repeatability and backlash together
//
// A feature with its own sigma uses that.  The simulation draws along these directions, and the
// predicted covariance differentiates along them, so both use the same noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal {

/// Standard deviations of measurements.
struct MeasurementNoise {
  double pixel = 0.3;      ///< pixels
  double depth = 0.001;    ///< at 1 m, metres; grows with the square
  double point = 5e-5;     ///< metres
  double rotation = 1e-4;  ///< radians
  double joint = 7e-5;     ///< radians or metres
};

namespace detail {

/// True if the features of an observation are pixels.
[[nodiscard]] inline bool measures_pixels(const MountedSensor& sensor, const Observation& seen) {
  return seen.camera && sensor.sensor().delivers(Quantity::pixel);
}

}  // namespace detail

/// A small change of a feature: of its point, and of its orientation as a rotation vector.
struct FeatureChange {
  Vector3<double> point = Vector3<double>::Zero();     ///< (3) metres or pixels
  Vector3<double> rotation = Vector3<double>::Zero();  ///< (3) radians, in the feature's frame
};

/// A feature after a change.
[[nodiscard]] Feature changed(const Feature& feature, const FeatureChange& change, double factor);

/// The independent errors of a feature, each of one standard deviation: three, and three more for
/// an orientation.
/// @param sensor  that measured it
[[nodiscard]] std::vector<FeatureChange> errors_of(const MountedSensor& sensor,
                                                   const Observation& seen, const Feature& feature,
                                                   const MeasurementNoise& noise);

/// The sensors that measure: cameras, and those whose features differ between samples.  The others
/// hold targets with known points: LEDs, corners of a board.  Every error block has at least one.
/// @param problem  its sensors and error blocks
[[nodiscard]] std::set<std::string> measuring_sensors(const AnyProblem& problem,
                                                      std::span<const Sample> samples);

/// A sample with noise on every joint position and every feature of these sensors.
[[nodiscard]] Sample with_noise(const Sample& exact, const AnyProblem& problem,
                                const std::set<std::string>& measuring,
                                const MeasurementNoise& noise, SeededRandom& random);

}  // namespace kinecal
