// The built-in sensors, evaluated in packets: a unit of their own in the library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/views/sensor_code.hpp"
#include "kinecal/sensors/built_in_sensor.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal::detail {

extern template class SensorCodeOf<ChainPoint, Packet>;
extern template class SensorCodeOf<ChainPose, Packet>;
extern template class SensorCodeOf<BentBoard, Packet>;
extern template class SensorCodeOf<DepthCamera, Packet>;
extern template class SensorCodeOf<LensCamera<PlumbBob>, Packet>;
extern template class SensorCodeOf<LensCamera<RationalPolynomial>, Packet>;
extern template class SensorCodeOf<LensCamera<ThinPrism>, Packet>;
extern template class SensorCodeOf<LensCamera<Equidistant>, Packet>;
extern template class SensorCodeOf<LensCamera<DoubleSphere>, Packet>;

}  // namespace kinecal::detail
#endif
