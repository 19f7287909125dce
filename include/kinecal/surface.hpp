// Umbrella header of surface/: the surface of a robot, what it is nearest to and what rays hit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/surface/mask_search.hpp"
#include "kinecal/surface/outline.hpp"
#include "kinecal/surface/outline_match.hpp"
#include "kinecal/surface/pose_search.hpp"
#include "kinecal/surface/robot_surface.hpp"
#include "kinecal/surface/surface_match.hpp"
#include "kinecal/surface/triangle_tree.hpp"
