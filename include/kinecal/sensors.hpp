// Umbrella header of sensors/: cameras and other sensors, with their parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/sensors/bent_board.hpp"
#include "kinecal/sensors/built_in_sensor.hpp"
#include "kinecal/sensors/camera_image.hpp"
#include "kinecal/sensors/chain_point.hpp"
#include "kinecal/sensors/depth_camera.hpp"
#include "kinecal/sensors/double_sphere.hpp"
#include "kinecal/sensors/equidistant.hpp"
#include "kinecal/sensors/lens.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/sensors/lens_model.hpp"
#include "kinecal/sensors/lens_names.hpp"
#include "kinecal/sensors/plumb_bob.hpp"
#include "kinecal/sensors/quantity.hpp"
#include "kinecal/sensors/quantity_vectors.hpp"
#include "kinecal/sensors/rational_polynomial.hpp"
#include "kinecal/sensors/sensor.hpp"
#include "kinecal/sensors/sensor_checks.hpp"
