// What built_in_sensors.hpp declares, compiled.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/built_in_sensors.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal::detail {

template class SensorCodeOf<ChainPoint, Packet>;
template class SensorCodeOf<ChainPose, Packet>;
template class SensorCodeOf<BentBoard, Packet>;
template class SensorCodeOf<DepthCamera, Packet>;
template class SensorCodeOf<LensCamera<PlumbBob>, Packet>;
template class SensorCodeOf<LensCamera<RationalPolynomial>, Packet>;
template class SensorCodeOf<LensCamera<ThinPrism>, Packet>;
template class SensorCodeOf<LensCamera<Equidistant>, Packet>;
template class SensorCodeOf<LensCamera<DoubleSphere>, Packet>;

}  // namespace kinecal::detail
#endif
