// What built_in_sensors.hpp declares, compiled.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/built_in_sensors.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal::detail {
KINECAL_SENSOR_CODE();
}  // namespace kinecal::detail
#endif
