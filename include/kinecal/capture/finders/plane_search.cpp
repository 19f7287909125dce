// Definitions of plane_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/plane_search.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/capture/finders/spread.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal {
namespace detail {
namespace {

using PlanePoints = std::vector<Vector3<double>>;

/// Another plane of comparable size among the points that are not on a plane; empty if there is
/// none.
std::string rival_plane(const PlanePoints& points, const ScoredPlane& first,
                        const PlaneSearch& search, bool by_prior) {
  constexpr double kRival = 0.7, kSameAngle = 0.1, kSameDistance = 3.0;  // tolerances
  const PlanePoints others = points_near_plane(points, first.plane, 2.0 * search.tolerance, false);
  const ScoredPlane second = best_plane(others, search, by_prior);
  if (static_cast<double>(second.count) < kRival * static_cast<double>(first.count)) return "";
  const double tilt =
      std::acos(std::min(1.0, std::abs(first.plane.normal.dot(second.plane.normal))));
  const double gap = std::abs(plane_distance(first.plane, second.plane.centroid));
  if (tilt < kSameAngle && gap < kSameDistance * search.tolerance)
    return "";  // the same plane, bent
  return "two planes have about as many points, " + reading(gap, "m") + " and " +
         reading(tilt, "rad") + " apart; make the box smaller, or expect a normal and an offset";
}

/// Three standard deviations of the points near a plane, but not more than the tolerance.
double plane_noise_limit(std::span<const Vector3<double>> points, const Plane<double>& plane,
                         double tolerance) {
  constexpr double kLeast = 0.1;  // of the tolerance
  std::vector<double> distances;
  for (const Vector3<double>& p : points) {
    const double distance = std::abs(plane_distance(plane, p));
    if (distance <= tolerance) distances.push_back(distance);
  }
  if (distances.empty()) return tolerance;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return std::clamp(3.0 * 1.4826 * *middle, kLeast * tolerance, tolerance);
}

PlanePoints some_points(std::span<const Vector3<double>> points, std::size_t count) {
  PlanePoints some;
  for (const std::size_t i : thinned(points.size(), count)) some.push_back(points[i]);
  return some;
}

/// The dominant plane of some of the points, or why it is missing.
ScoredPlane dominating_plane(const PlanePoints& points, const PlaneSearch& search, bool by_prior,
                             std::string& problem) {
  const auto share = [&](const ScoredPlane& plane) {
    return static_cast<double>(plane.count) /
           static_cast<double>(std::max<std::size_t>(1, points.size()));
  };
  ScoredPlane best = best_plane(points, search, by_prior);
  if (best.count >= 3 && share(best) >= search.least_share) return best;
  const ScoredPlane any = by_prior ? best_plane(points, search, false) : best;
  if (any.count >= 3 && share(any) >= search.least_share) {
    problem = plane_off_prior(any.plane, search);
  }
  if (!problem.empty()) {
    problem = "the plane is not the expected one: " + problem;
    return best;
  }
  problem = "no plane dominates: the best has " +
            std::to_string(static_cast<int>(100.0 * share(any))) + " % of the points in the box";
  return best;
}

/// Least squares on the points near a plane; in the end, the tolerance is that of the noise.
void fit_plane(const PlanePoints& points, Plane<double>& plane, double& tolerance) {
  const double most = tolerance;
  for (int round = 0; round < 3; ++round) {
    if (const auto better = refitted_plane(points, plane, tolerance)) plane = *better;
    tolerance = plane_noise_limit(points, plane, most);
  }
}

}  // namespace
}  // namespace detail

FoundPlane find_plane(std::span<const Vector3<double>> points, const PlaneSearch& search) {
  constexpr std::size_t kScored = 2048, kFitted = 8192;  // points; more would not change the plane
  FoundPlane found;
  const detail::PlanePoints scored = detail::some_points(points, kScored);
  const bool by_prior = search.normal.norm() > 0.0;
  const ScoredPlane best = detail::dominating_plane(scored, search, by_prior, found.problem);
  if (!found.problem.empty()) return found;
  Plane<double> plane = best.plane;
  found.tolerance = search.tolerance;
  detail::fit_plane(detail::some_points(points, kFitted), plane, found.tolerance);
  found.problem = plane_off_prior(plane, search);
  if (!found.problem.empty()) found.problem = "the plane is not the expected one: " + found.problem;
  if (found.problem.empty()) found.problem = detail::rival_plane(scored, best, search, by_prior);
  if (!found.problem.empty()) return found;
  const Vector3<double> towards = by_prior ? search.normal : Vector3<double>(-plane.centroid);
  if (plane.normal.dot(towards) < 0.0) plane.normal = -plane.normal;
  found.plane = plane;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(plane_distance(plane, points[i])) <= found.tolerance) found.inliers.push_back(i);
  }
  return found;
}

}  // namespace kinecal
