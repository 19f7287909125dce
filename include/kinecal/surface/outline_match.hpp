// The edges of masks on the outline of the robot, and the outline on the edges: which belong together.
//
// Association stands outside of the solve, as in surface_match.hpp.  Each edge of a mask gets the nearest point of the
// outline, and each point of the outline the nearest edge; only those whose normals agree.  Both kinds are ordinary
// features: a point on a link, the pixel of an edge, and the direction between them: see errors/point_to_outline.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/surface/outline.hpp"
#include "kinecal/surface/surface_match.hpp"

namespace kinecal {

/// A point of the outline with an edge of a mask.
struct OutlineHit {
  int edge = -1;  ///< feature of the camera; negative: none within the bound
  OutlinePoint on =
      {};  ///< of the outline; its normal is the direction in which the distance counts
  double distance = std::numeric_limits<double>::infinity();  ///< pixels
};

/// What belongs together in a sample.
struct OutlineMatch {
  std::vector<OutlineHit>
      edges;  ///< of each feature of the camera: the nearest point of the outline
  std::vector<OutlineHit> outline;  ///< of each point of the outline: the nearest edge

  /// Calls a function for all of them.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const OutlineHit& hit : edges) visit(hit);
    for (const OutlineHit& hit : outline) visit(hit);
  }
};

/// By sample.
using OutlineHits = std::vector<OutlineMatch>;

/// Associates masks and outlines.
/// @param pair     the camera observes edges of masks: pixels, with their outward normals as conditions nu, nv if known
/// @param problem  has both sensors; its samples do not matter
/// @param values   of all parameters of its table
/// @param bound    pixels; what is farther apart does not belong together
/// @param threads  number of threads; zero: one per core.  Does not affect the result
/// @throws SampleError  if a sample lacks a joint
[[nodiscard]] OutlineHits match_outlines(const Outliner& outliner, const RobotSurface& surface,
                                         const SurfacePair& pair, const AnyProblem& problem,
                                         ParameterValues values, std::span<const Sample> samples,
                                         double bound, int threads);

/// The samples with what belongs together: edges beyond the gate are left out.
/// @param gate  pixels
[[nodiscard]] std::vector<Sample> with_outline(const RobotSurface& surface, const SurfacePair& pair,
                                               std::span<const Sample> samples,
                                               const OutlineHits& hits, double gate);

}  // namespace kinecal
