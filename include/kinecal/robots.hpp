// Umbrella header of robots/: robots behind a Foxglove bridge or a pipe.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/robots/bridge_client.hpp"
#include "kinecal/robots/bridge_frames.hpp"
#include "kinecal/robots/child_process.hpp"
#include "kinecal/robots/pipe_robot.hpp"
#include "kinecal/robots/ros_action.hpp"
#include "kinecal/robots/ros_base.hpp"
#include "kinecal/robots/ros_robot.hpp"
#include "kinecal/robots/socket/web_socket.hpp"
#include "kinecal/robots/view_ahead.hpp"
