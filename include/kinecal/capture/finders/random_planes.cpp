// Definitions of random_planes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/random_planes.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal {
namespace detail {
namespace {

/// The number of points within the tolerance of a plane.
std::size_t plane_support(std::span<const Vector3<double>> points, const Plane<double>& plane,
                          double tolerance) {
  const double offset = plane.normal.dot(plane.centroid);
  std::size_t count = 0;
  for (const Vector3<double>& p : points) {
    count += static_cast<std::size_t>(std::abs(plane.normal.dot(p) - offset) <= tolerance);
  }
  return count;
}

/// A plane of three of the points; nullopt if they are too close to a line.
std::optional<Plane<double>> random_plane(std::span<const Vector3<double>> points,
                                          std::mt19937_64& random) {
  const auto any = [&]() -> const Vector3<double>& { return points[random() % points.size()]; };
  const Vector3<double>& a = any();
  const Vector3<double> ab = any() - a, ac = any() - a;
  const Vector3<double> normal = cross(ab, ac);
  const double area = normal.norm();
  if (!(area > 0.05 * ab.norm() * ac.norm())) return std::nullopt;
  return Plane<double>{a, normal / area};
}

}  // namespace
}  // namespace detail

std::vector<Vector3<double>> points_near_plane(std::span<const Vector3<double>> points,
                                               const Plane<double>& plane, double tolerance,
                                               bool on_it) {
  std::vector<Vector3<double>> chosen;
  for (const Vector3<double>& p : points) {
    if ((std::abs(plane_distance(plane, p)) <= tolerance) == on_it) chosen.push_back(p);
  }
  return chosen;
}

std::optional<Plane<double>> refitted_plane(std::span<const Vector3<double>> points,
                                            const Plane<double>& plane, double tolerance) {
  const std::vector<Vector3<double>> near = points_near_plane(points, plane, tolerance);
  if (near.size() < 3) return std::nullopt;
  const PlaneFit<double> fit(near);
  if (!fit.determined()) return std::nullopt;
  return fit.plane();
}

std::string plane_off_prior(const Plane<double>& plane, const PlaneSearch& search, double slack) {
  const double length = search.normal.norm();
  if (!(length > 0.0)) return "";
  const Vector3<double> expected = search.normal / length;
  const double angle = std::acos(std::min(1.0, std::abs(expected.dot(plane.normal))));
  if (angle > slack * search.normal_angle) {
    return "it is tilted by " + reading(angle, "rad") + " from the expected normal, at most " +
           reading(search.normal_angle, "rad") + " are allowed";
  }
  const double side = expected.dot(plane.normal) < 0.0 ? -1.0 : 1.0;
  const double offset = side * plane.normal.dot(plane.centroid);
  if (!search.offset || std::abs(offset - *search.offset) <= slack * search.offset_tolerance) {
    return "";
  }
  return "it is at " + reading(offset, "m") + " along the expected normal, expected at " +
         reading(*search.offset, "m") + " with a tolerance of " +
         reading(search.offset_tolerance, "m");
}

ScoredPlane best_plane(std::span<const Vector3<double>> points, const PlaneSearch& search,
                       bool by_prior) {
  constexpr double kSlack = 1.5;  // of three noisy points
  constexpr double kMiss = 1e-6;  // chance that the best plane is missed
  ScoredPlane best;
  if (points.size() < 3) return best;
  std::mt19937_64 random(search.seed);
  double needed = search.iterations;
  for (int i = 0; i < search.iterations && i < needed; ++i) {
    auto plane = detail::random_plane(points, random);
    if (!plane || (by_prior && !plane_off_prior(*plane, search, kSlack).empty())) continue;
    std::size_t count = detail::plane_support(points, *plane, search.tolerance);
    if (count <= best.count) continue;
    if (const auto better = refitted_plane(points, *plane, search.tolerance)) {
      const std::size_t more = detail::plane_support(points, *better, search.tolerance);
      if (more >= count) {
        plane = better;
        count = more;
      }
    }
    best = {*plane, count};
    const double share = static_cast<double>(count) / static_cast<double>(points.size());
    const double hit = std::min(share * share * share, 1.0 - 1e-9);
    needed = std::log(kMiss) / std::log1p(-hit);
  }
  return best;
}

}  // namespace kinecal
