// Umbrella header of capture/: from a robot or a recording to samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/find_leds.hpp"
#include "kinecal/capture/image.hpp"
#include "kinecal/capture/image_motion.hpp"
#include "kinecal/capture/led_difference.hpp"
#include "kinecal/capture/led_finder.hpp"
#include "kinecal/capture/led_search.hpp"
#include "kinecal/capture/light_blob.hpp"
#include "kinecal/capture/plane_finder.hpp"
#include "kinecal/capture/plane_search.hpp"
#include "kinecal/capture/random_planes.hpp"
#include "kinecal/capture/region.hpp"
#include "kinecal/capture/robot_finder.hpp"
#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/capture/scan_finder.hpp"
#include "kinecal/capture/spread.hpp"
#include "kinecal/capture/surface_point.hpp"
#include "kinecal/capture/view.hpp"
#include "kinecal/capture/view_checks.hpp"
