// Umbrella header of errors/: error blocks, priors and losses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/block_checks.hpp"
#include "kinecal/errors/built_in_block.hpp"
#include "kinecal/errors/difference.hpp"
#include "kinecal/errors/error_block.hpp"
#include "kinecal/errors/loss.hpp"
#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/errors/plane_to_plane.hpp"
#include "kinecal/errors/point_distance.hpp"
#include "kinecal/errors/point_to_line.hpp"
#include "kinecal/errors/point_to_mesh.hpp"
#include "kinecal/errors/point_to_outline.hpp"
#include "kinecal/errors/point_to_pixel.hpp"
#include "kinecal/errors/point_to_plane.hpp"
#include "kinecal/errors/point_to_point.hpp"
#include "kinecal/errors/point_to_ray.hpp"
#include "kinecal/errors/point_to_sphere.hpp"
#include "kinecal/errors/pose_to_pose.hpp"
#include "kinecal/errors/prior.hpp"
#include "kinecal/errors/ray_to_ray.hpp"
