// The error blocks that the library has compiled.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/errors/gravity_seen.hpp"
#include "kinecal/errors/magnetic_field.hpp"
#include "kinecal/errors/plane_to_plane.hpp"
#include "kinecal/errors/point_distance.hpp"
#include "kinecal/errors/point_on_line.hpp"
#include "kinecal/errors/point_on_plane.hpp"
#include "kinecal/errors/point_to_line.hpp"
#include "kinecal/errors/point_to_mesh.hpp"
#include "kinecal/errors/point_to_outline.hpp"
#include "kinecal/errors/point_to_pixel.hpp"
#include "kinecal/errors/point_to_plane.hpp"
#include "kinecal/errors/point_to_point.hpp"
#include "kinecal/errors/point_to_ray.hpp"
#include "kinecal/errors/point_to_sphere.hpp"
#include "kinecal/errors/pose_to_pose.hpp"
#include "kinecal/errors/ray_to_ray.hpp"

namespace kinecal {

/// An error block of a built-in type.
using BuiltInBlock =
    std::variant<PointToPoint, PointToPixel, PointToPlane, PlaneToPlane, PointDistance, PointToLine,
                 PointToSphere, PoseToPose, RayToRay, PointToRay, PointToMesh, PointToOutline,
                 PointOnPlane, PointOnLine, GravitySeen, DifferentialToPose, DifferentialToWall,
                 MecanumToPose, MecanumToWall, TricycleToPose, TricycleToWall, OdometryToPose,
                 OdometryToWall, GyroToPose, GyroToWall, MagneticField>;

}  // namespace kinecal
