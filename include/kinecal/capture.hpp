// Umbrella header of capture/: from a robot or a recording to samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"
#include "kinecal/capture/pose_generation.hpp"
#include "kinecal/capture/robot_body.hpp"
#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/capture/view.hpp"
