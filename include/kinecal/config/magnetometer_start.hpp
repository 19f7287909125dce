// Where the calibration of a magnetometer begins, and what a turn about one axis does not show.
//
//   |m|^2 = 2 b . m + F^2 - |b|^2       linear in b and in what is left: the start
//
// Readings of a base that turns in place are in a plane, but for their noise, which would seem to show the bias along its
// normal, and the field.  They are put into that plane: neither is determined then, and the result says so.  A normal within a
// degree of an axis of the sensor is that axis, so that the other two components of the bias are determined.
// Source: Kasa, A circle fitting procedure and its error analysis, 1976.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A plane in which all readings of a magnetometer are.
struct ReadingsPlane {
  Vector3<double> mean = Vector3<double>::Zero();    ///< (3) of the readings, microtesla
  Vector3<double> normal = Vector3<double>::Zero();  ///< (3) of length one
  double beside = 0.0;  ///< microtesla: root of the mean square of their distance
};

/// The plane; nullopt if they turned about several axes, or there are fewer than four.
[[nodiscard]] std::optional<ReadingsPlane> plane_of_readings(std::span<const Sample> samples);

/// Lets blocks of a magnetometer that give neither a bias nor a field begin where the readings suggest them, and puts readings of
/// a turn about one axis into their plane.
/// @param diagnostics  receives a note of such a plane; errors of readings that do not vary, and of soft iron that is free
///                     beside a field that goes with it
void begin_magnetometer(Config& config, std::vector<Sample>& samples, Diagnostics& diagnostics);

}  // namespace kinecal
