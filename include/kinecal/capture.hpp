// Umbrella header of capture/: from a robot or a recording to samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/any_robot.hpp"
#include "kinecal/capture/capture_pose.hpp"
#include "kinecal/capture/image.hpp"
#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/capture/session.hpp"
#include "kinecal/capture/settling.hpp"
#include "kinecal/capture/view.hpp"
