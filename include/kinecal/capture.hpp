// Umbrella header of capture/: from a robot or a recording to samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/april_tag_finder.hpp"
#include "kinecal/capture/april_tags.hpp"
#include "kinecal/capture/board_flips.hpp"
#include "kinecal/capture/board_order.hpp"
#include "kinecal/capture/charuco_finder.hpp"
#include "kinecal/capture/checkerboard_finder.hpp"
#include "kinecal/capture/corner_depth.hpp"
#include "kinecal/capture/grid_corners.hpp"
#include "kinecal/capture/homography.hpp"
#include "kinecal/capture/image.hpp"
#include "kinecal/capture/opencv_corners.hpp"
#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/capture/square_edges.hpp"
#include "kinecal/capture/tag_edges.hpp"
#include "kinecal/capture/target.hpp"
#include "kinecal/capture/turn_votes.hpp"
#include "kinecal/capture/view.hpp"
