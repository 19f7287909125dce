// The points of a depth camera on the surface of the robot: which link each lies on, and where.
//
// Association stands outside of the solve: with the robot and the camera where some values of the parameters put them, each
// point gets the nearest point of the surface.  Those are an ordinary observation of a chain3d sensor, with the normal as
// conditions: see errors/point_to_mesh.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/surface/robot_surface.hpp"

namespace kinecal {

/// A camera, and the sensor that stands for the surface of the robot where the camera sees it.
struct SurfacePair {
  std::string camera;  ///< name of a sensor that places points
  std::string robot;   ///< name of a chain3d sensor whose links are those of the surface
};

/// The nearest points of the surface, by sample and point of the camera.
using SurfaceHits = std::vector<std::vector<SurfaceHit>>;

/// The poses of the links of a surface in the base.
/// @param problem  has the sensor; its samples do not matter
/// @param values   of all parameters of its table
/// @throws SampleError  if the sample lacks a joint
[[nodiscard]] std::vector<Pose<double>> link_poses(const RobotSurface& surface,
                                                   const SurfacePair& pair,
                                                   const AnyProblem& problem,
                                                   ParameterValues values, const Sample& sample);

/// Associates the points of a camera.
/// @param problem  has both sensors; its samples do not matter
/// @param values   of all parameters of its table
/// @param bound    metres; a point that is farther from the surface gets no link
/// @param threads  number of threads; zero: one per core.  Does not affect the result
/// @param hits     in: those of the same samples for other values, or empty; out
/// @throws SampleError  if a sample lacks a joint
void associate(const RobotSurface& surface, const SurfacePair& pair, const AnyProblem& problem,
               ParameterValues values, std::span<const Sample> samples, double bound, int threads,
               SurfaceHits& hits);

/// A feature of a camera, and the place on a link that belongs to it.
struct SurfaceFeature {
  int link = -1;    ///< number of the link in the surface
  Feature seen;     ///< by the camera
  Feature on_link;  ///< its frame is set
};

/// Replaces what a camera observed in a sample by what belongs to the surface, link after link.
void set_matched(const RobotSurface& surface, const SurfacePair& pair,
                 std::vector<SurfaceFeature> features, Sample& sample);

/// The samples with the observation of the surface; points beyond the gate are left out.
/// @param hits  of all points of the camera
/// @param gate  metres
[[nodiscard]] std::vector<Sample> with_surface(const RobotSurface& surface, const SurfacePair& pair,
                                               std::vector<Sample> samples, const SurfaceHits& hits,
                                               double gate);

/// The samples with at most so many points of a sensor each, evenly from its list.
[[nodiscard]] std::vector<Sample> with_fewer_points(std::span<const Sample> samples,
                                                    const std::string& sensor, int points);

}  // namespace kinecal
