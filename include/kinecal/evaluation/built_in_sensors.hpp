// The built-in sensors, evaluated in packets: a unit of their own in the library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/views/sensor_code.hpp"
#include "kinecal/sensors/built_in_sensor.hpp"

#ifndef KINECAL_HEADER_ONLY
/// Instances of all sensors of BuiltInSensor, declared (`extern`) or defined.
#define KINECAL_SENSOR_CODE(storage)                                           \
  storage template class SensorCodeOf<ChainPoint, Packet>;                     \
  storage template class SensorCodeOf<ChainPose, Packet>;                      \
  storage template class SensorCodeOf<BentBoard, Packet>;                      \
  storage template class SensorCodeOf<DepthCamera, Packet>;                    \
  storage template class SensorCodeOf<LensCamera<PlumbBob>, Packet>;           \
  storage template class SensorCodeOf<LensCamera<RationalPolynomial>, Packet>; \
  storage template class SensorCodeOf<LensCamera<ThinPrism>, Packet>;          \
  storage template class SensorCodeOf<LensCamera<Equidistant>, Packet>;        \
  storage template class SensorCodeOf<LensCamera<DoubleSphere>, Packet>

namespace kinecal::detail {
KINECAL_SENSOR_CODE(extern);
}  // namespace kinecal::detail
#endif
