// What a sensor delivers to an error block for each feature: a point, a ray, a pose, a reading or a
// pixel.
//
// The sensor computes it in its own frame; the error block receives it in the base.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// Kinds of input that a block takes from a sensor.
enum class Quantity {
  point,    ///< Vector3<S>: a point
  ray,      ///< Ray<S>: the line of sight to a point
  pose,     ///< Pose<S>: the pose of a marker or a tracked body
  reading,  ///< Reading<S>: one number, such as a length
  pixel,    ///< PixelObservation<S>: where a camera should see the point of the previous sensor
  plane     ///< Plane<S>: the plane through all points
};

/// Its name in messages: "points".
[[nodiscard]] constexpr std::string_view to_string(Quantity quantity) {
  constexpr std::string_view kNames[] = {"points", "rays", "poses", "readings", "pixels", "points"};
  return kNames[static_cast<int>(quantity)];
}

/// The line of sight to a point.
template <class S>
struct Ray {
  Vector3<S> origin = Vector3<S>::Zero();  ///< (3) of the camera, metres
  Vector3<S> direction;                    ///< (3) of any length
  Vector3<S> by_u = Vector3<S>::Zero();    ///< (3) change of the direction per pixel to the right
  Vector3<S> by_v = Vector3<S>::Zero();    ///< (3) change of the direction per pixel downwards
};

/// One number that a sensor measured, and where the sensor is.
template <class S>
struct Reading {
  Vector3<S> origin = Vector3<S>::Zero();  ///< (3) of the sensor's frame, metres
  S value{0.0};                            ///< in the sensor's unit
};

/// A pixel that a camera observed, and the one at which it should see the point.
template <class S>
struct PixelObservation {
  Eigen::Matrix<S, 2, 1> predicted;          ///< (2) pixels, of the point of another sensor
  Eigen::Matrix<ValueOf<S>, 2, 1> observed;  ///< (2) pixels
};

/// The plane through some points, in the base.
template <class S>
struct Plane {
  Vector3<S> centroid;  ///< (3) of the points, metres, in the base
  Vector3<S> normal;    ///< (3) unit vector, in the base
};

}  // namespace kinecal
