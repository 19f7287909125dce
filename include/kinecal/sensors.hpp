// Umbrella header of sensors/: cameras and other sensors, with their parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/depth_camera.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"
#include "kinecal/sensors/sensor.hpp"
